#include "planet/mesh/segment_arrays.h"

#include <algorithm>
#include <cstring>

#include "planet/parallel.h"

namespace planet {

namespace {

/// Room for the meshes of views at half a pixel, made at once: memory that is not used costs nothing, but moving 10 MB to
/// a larger place takes 10 ms of one frame, most of it for new pages.
constexpr std::size_t usual_vertices = 1 << 20;

/// Sorts ranges and joins those that touch or overlap.
void join(std::vector<Range>& ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
    std::size_t kept = 0;
    for (const Range& r : ranges) {
        Range* const last = kept > 0 ? &ranges[kept - 1] : nullptr;
        if (last && r.first <= last->first + last->count)
            last->count = std::max(last->count, r.first + r.count - last->first);
        else
            ranges[kept++] = r;
    }
    ranges.resize(kept);
}

template <class T>
void copy(GrowingArray<T>& to, std::uint32_t at, std::span<const T> from, std::uint32_t first, std::uint32_t count) {
    if (count > 0) std::memcpy(to.data() + at, from.data() + first, count * sizeof(T));
}

}  // namespace

// What is built again mostly has as many vertices as before, or nearly. What outgrew its place is likely to do so again.
SegmentPlace SegmentArrays::place(const BuiltSegment& built, const SegmentBuilder& builder, const SegmentPlace* old) {
    SegmentPlace place;
    if (old && built.vertices <= old->vertices.count && built.indices <= old->indices.count) {
        place = *old;
    } else {
        if (old) release(*old);
        const auto room = [&](std::uint32_t count) { return old ? (count + 31) / 32 * 32 : count; };
        place.vertices = vertex_places_.allocate(room(built.vertices));
        place.indices = index_places_.allocate(room(built.indices));
    }
    unwritten_.push_back({&builder, built, place});
    return place;
}

void SegmentArrays::release(const SegmentPlace& place) {
    vertex_places_.free(place.vertices);
    index_places_.free(place.indices);
}

void SegmentArrays::begin_changes() {
    changed_vertices_.clear();
    changed_indices_.clear();
    written_ = 0;
}

void SegmentArrays::end_changes() {
    join(changed_vertices_);
    join(changed_indices_);
}

void SegmentArrays::write(bool morph, std::size_t threads) {
    if (vertices_.size() == 0) reserve(morph);
    resize(morph);
    for (const Unwritten& u : unwritten_) {
        changed_vertices_.push_back({u.place.vertices.first, u.segment.vertices});
        changed_indices_.push_back({u.place.indices.first, u.segment.indices});
    }
    constexpr std::size_t run = 64;
    parallel_for((unwritten_.size() + run - 1) / run, static_cast<unsigned>(threads), [&](std::size_t r) {
        for (std::size_t k = r * run; k < std::min(unwritten_.size(), (r + 1) * run); ++k) write(unwritten_[k], morph);
    });
    written_ += unwritten_.size();
    unwritten_.clear();
}

void SegmentArrays::reserve(bool morph) {
    vertices_.reserve_more(usual_vertices);
    if (morph) morphs_.reserve_more(usual_vertices);
    indices_.reserve_more(2 * usual_vertices);
    leaf_levels_.reserve_more(2 * usual_vertices);
}

// Places that were let go since may lie behind all that are in use: what is written, or listed as changed, is still there.
void SegmentArrays::resize(bool morph) {
    std::size_t vertices = vertex_places_.size(), indices = index_places_.size();
    if (written_ > 0) {
        vertices = std::max(vertices, vertices_.size());
        indices = std::max(indices, indices_.size());
    }
    for (const Unwritten& u : unwritten_) {
        vertices = std::max<std::size_t>(vertices, u.place.vertices.first + u.segment.vertices);
        indices = std::max<std::size_t>(indices, u.place.indices.first + u.segment.indices);
    }
    vertices_.resize(vertices);
    if (morph) morphs_.resize(vertices);
    indices_.resize(indices);
    leaf_levels_.resize(indices);
}

void SegmentArrays::write(const Unwritten& u, bool morph) {
    const BuiltSegment& s = u.segment;
    copy(vertices_, u.place.vertices.first, u.from->vertices(), s.first_vertex, s.vertices);
    if (morph) copy(morphs_, u.place.vertices.first, u.from->morphs(), s.first_vertex, s.vertices);
    copy(indices_, u.place.indices.first, u.from->indices(), s.first_index, s.indices);
    copy(leaf_levels_, u.place.indices.first, u.from->leaf_levels(), s.first_leaf, s.leaves);
}

void SegmentArrays::clear() {
    vertex_places_.clear();
    index_places_.clear();
    unwritten_.clear();
}

}  // namespace planet
