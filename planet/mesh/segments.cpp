#include "planet/mesh/segments.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

#include "planet/parallel.h"

namespace planet {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Finds a cell that is split in a mesh.
PlacedCell find_split_cell(const TileSource& tiles, LocationCode cell) {
    const int below = cell.bisection_level() - tiles.layers().root_level(cell.bisection_level());
    const PlacedTile* tile = tiles.tile(cell.ancestor(cell.bisection_level() - below));
    assert(tile != nullptr);
    return {tile, static_cast<unsigned>(cell.bits() & ((1u << below) - 1)) | 1u << below};
}

/// Sorts ranges and joins those that touch.
void join(std::vector<Range>& ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
    std::size_t kept = 0;
    for (const Range& r : ranges) {
        if (kept > 0 && ranges[kept - 1].first + ranges[kept - 1].count == r.first)
            ranges[kept - 1].count += r.count;
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

/// A segment of a block, before it has a place.
struct Segments::Part {
    static constexpr std::uint32_t is_new = 0xffffffff;

    LocationCode cell;
    std::uint32_t leaves;
    std::uint32_t piece;  ///< as it is in the block, or is_new
    BuiltSegment built{};
};

/// A block to be brought up to date.
struct Segments::Job {
    PlacedCell cell;
    std::uint32_t block;
    std::vector<Part> parts{};
    const SegmentBuilder* builder = nullptr;
};

void Segments::build(const TileSource& tiles, const SegmentView& view, int threads) {
    clear();
    update(tiles, view, threads);
}

void Segments::update(const TileSource& tiles, const SegmentView& view, int threads) {
    changed_vertices_.clear();
    changed_indices_.clear();
    built_ = 0;
    if (tiles_from_ != &tiles || !view.same_but_for_eye_and_culling(view_)) clear();
    const bool at_rest = listed_ && view.test.eye == view_.test.eye && view.culling == view_.culling;
    tiles_from_ = &tiles;
    view_ = view;
    if (at_rest) return;
    tree_.update(tiles, view);
    release_dropped();
    std::vector<Job> jobs = stale_blocks();
    build_all(tiles, jobs, static_cast<std::size_t>(std::max(threads, 1)));
    place(jobs, static_cast<std::size_t>(std::max(threads, 1)));
    list();
    shed_unseen();
    listed_ = true;
}

void Segments::invalidate(std::span<const LocationCode> tile_roots) {
    tree_.invalidate(tile_roots);
    release_dropped();
    listed_ = listed_ && tile_roots.empty();
}

void Segments::clear() {
    tree_.clear();
    blocks_.clear();
    free_blocks_.clear();
    segments_.clear();
    listed_ = false;
    vertex_places_.clear();
    index_places_.clear();
    total_leaves_ = 0;
}

std::vector<Segments::Job> Segments::stale_blocks() {
    std::vector<Job> jobs;
    for (const auto [i, open] : tree_.in_view()) {
        SegmentNode& n = tree_.node(i);
        if (n.content == SegmentNode::none) {
            if (free_blocks_.empty()) {
                n.content = static_cast<std::uint32_t>(blocks_.size());
                blocks_.emplace_back();
            } else {
                n.content = free_blocks_.back();
                free_blocks_.pop_back();
            }
        }
        if (tree_.odometer() >= blocks_[n.content].expires) jobs.push_back({{n.tile, n.local}, n.content});
    }
    return jobs;
}

// Neighbours share tiles, so a thread takes several in a row.
void Segments::build_all(const TileSource& tiles, std::span<Job> jobs, std::size_t threads) {
    constexpr std::size_t run = 4;
    const std::size_t workers = std::min(threads, (jobs.size() + run - 1) / run);
    while (builders_.size() < workers) builders_.push_back(std::make_unique<SegmentBuilder>());
    std::atomic<std::size_t> next = 0;
    parallel_for(workers, static_cast<unsigned>(workers), [&](std::size_t w) {
        builders_[w]->begin(tiles, view_);
        for (std::size_t first; (first = next.fetch_add(run, std::memory_order_relaxed)) < jobs.size();)
            for (Job& job : jobs.subspan(first, std::min(run, jobs.size() - first))) build(tiles, job, *builders_[w]);
    });
}

// What has expired is built again and may come out as several; where halves have become small enough to be one segment,
// it is made of them. Both depend on nothing but the leaves there are.
void Segments::build(const TileSource& tiles, Job& job, SegmentBuilder& builder) const {
    const Block& block = blocks_[job.block];
    const LocationCode half = job.cell.code();
    job.builder = &builder;
    std::vector<BuiltSegment> built;
    const auto add = [&](const Part& part) {
        job.parts.push_back(part);
        while (job.parts.size() > 1) {
            Part &a = job.parts[job.parts.size() - 2], &b = job.parts.back();
            if (a.cell == half || a.cell.sibling() != b.cell ||
                a.leaves + b.leaves > static_cast<std::uint32_t>(view_.segment_leaves))
                return;
            a = {.cell = a.cell.parent(), .leaves = a.leaves + b.leaves, .piece = Part::is_new};
            job.parts.pop_back();
        }
    };
    const auto add_built = [&] {
        for (const BuiltSegment& b : built)
            add({.cell = b.cell, .leaves = b.leaves, .piece = Part::is_new, .built = b});
        built.clear();
    };
    if (block.pieces.empty()) {
        builder.build(job.cell, half, built);
        add_built();
    }
    for (std::uint32_t k = 0; k < block.pieces.size(); ++k) {
        const Piece& piece = block.pieces[k];
        if (tree_.odometer() < piece.expires) {
            add({.cell = piece.segment.root, .leaves = piece.segment.leaves, .piece = k});
        } else {
            builder.build(piece.root, half, built);
            add_built();
        }
    }
    for (Part& part : job.parts)
        if (part.piece == Part::is_new && part.built.leaves == 0) {
            builder.build(find_split_cell(tiles, part.cell), half, built);
            assert(built.size() == 1 && built[0].cell == part.cell && built[0].leaves == part.leaves);
            part.built = built[0];
            built.clear();
        }
}

void Segments::place(std::span<Job> jobs, std::size_t threads) {
    for (Job& job : jobs) place(job);
    join(changed_vertices_);
    join(changed_indices_);
    vertices_.resize(vertex_places_.size());
    if (view_.morph) morphs_.resize(vertex_places_.size());
    indices_.resize(index_places_.size());
    leaf_levels_.resize(index_places_.size());
    constexpr std::size_t run = 16;
    parallel_for((jobs.size() + run - 1) / run, static_cast<unsigned>(threads), [&](std::size_t r) {
        for (const Job& job : jobs.subspan(r * run, std::min(run, jobs.size() - r * run)))
            for (std::size_t k = 0; k < job.parts.size(); ++k) {
                const auto& [cell, leaves, piece, b] = job.parts[k];
                if (piece != Part::is_new) continue;
                const Segment& s = blocks_[job.block].pieces[k].segment;
                copy(vertices_, s.first_vertex, job.builder->vertices(), b.first_vertex, b.vertices);
                if (view_.morph) copy(morphs_, s.first_vertex, job.builder->morphs(), b.first_vertex, b.vertices);
                copy(indices_, s.first_index, job.builder->indices(), b.first_index, b.indices);
                copy(leaf_levels_, s.first_leaf, job.builder->leaf_levels(), b.first_leaf, b.leaves);
            }
    });
}

/// Gives places to the new parts of a block.
void Segments::place(Job& job) {
    Block& block = blocks_[job.block];
    std::size_t next = 0;  // kept pieces are in order: those between them go
    const auto release_until = [&](std::size_t end) {
        for (; next < end; ++next) release(block.pieces[next].segment);
    };
    for (const Part& part : job.parts)
        if (part.piece != Part::is_new) {
            release_until(part.piece);
            ++next;
        }
    release_until(block.pieces.size());

    std::vector<Piece> pieces;
    pieces.reserve(job.parts.size());
    block.expires = infinity;
    for (const Part& part : job.parts) {
        pieces.push_back(part.piece == Part::is_new ? new_piece(part.built) : block.pieces[part.piece]);
        block.expires = std::min(block.expires, pieces.back().expires);
    }
    block.pieces = std::move(pieces);
}

Segments::Piece Segments::new_piece(const BuiltSegment& b) {
    const Range vertices = vertex_places_.allocate(b.vertices), indices = index_places_.allocate(b.indices);
    changed_vertices_.push_back(vertices);
    changed_indices_.push_back(indices);
    total_leaves_ += b.leaves;
    ++built_;
    return {.segment = {.root = b.cell,
                        .patch = b.patch,
                        .first_vertex = vertices.first,
                        .vertex_count = vertices.count,
                        .first_index = indices.first,
                        .index_count = indices.count,
                        .leaves = b.leaves,
                        .first_leaf = indices.first,
                        .detailed = b.detailed},
            .sphere = b.sphere,
            .expires = tree_.expiry(b.slack),
            .ratio_max = b.ratio_max,
            .least_reach = b.least_reach,
            .deviation_max = b.deviation_max,
            .odometer = tree_.odometer(),
            .root = b.root,
            .damaged = b.damaged};
}

// While the slack holds, what could be split needs not: its ratio is at most 1. What lacks a tile has come nearer by what
// the eye went at most, and the nearest by the largest factor.
double Segments::ratio_of(const Piece& p) const {
    const double gone = tree_.odometer() - p.odometer;
    if (gone == 0 || p.ratio_max == 0) return p.ratio_max;
    if (p.least_reach == infinity) return 1;
    return gone < p.least_reach ? std::max(1.0, p.ratio_max * (p.least_reach / (p.least_reach - gone))) : infinity;
}

void Segments::list() {
    segments_.clear();
    sums_ = {};
    const CullingTest culling(view_.culling);
    for (const auto [i, open] : tree_.in_view())
        for (const Piece& p : blocks_[tree_.node(i).content].pieces) {
            sums_.block_leaves += p.segment.leaves;
            unsigned still_open = open;
            if (culling.hidden(p.sphere.centre, p.sphere.radius, still_open)) continue;
            segments_.push_back(p.segment);
            sums_.leaves += p.segment.leaves;
            sums_.vertices += p.segment.vertex_count;
            sums_.indices += p.segment.index_count;
            sums_.damaged = sums_.damaged || p.damaged;
            sums_.ratio_max = std::max(sums_.ratio_max, ratio_of(p));
            sums_.deviation_max = std::max(sums_.deviation_max, p.deviation_max);
        }
    kept_ = total_leaves_ - sums_.block_leaves;
}

void Segments::release_dropped() {
    for (const std::uint32_t i : tree_.dropped()) {
        for (const Piece& p : blocks_[i].pieces) release(p.segment);
        blocks_[i] = {};
        free_blocks_.push_back(i);
    }
    tree_.clear_dropped();
}

void Segments::release(const Segment& s) {
    vertex_places_.free({s.first_vertex, s.vertex_count});
    index_places_.free({s.first_index, s.index_count});
    total_leaves_ -= s.leaves;
}

void Segments::shed_unseen() {
    if (kept_ <= view_.kept_leaves) return;
    for (const std::uint32_t i : tree_.hidden_longest_first()) {
        tree_.drop(i);
        release_dropped();
        kept_ = total_leaves_ - sums_.block_leaves;
        if (kept_ <= view_.kept_leaves) return;
    }
}

std::uint64_t Segments::hash() const {
    std::uint64_t h = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t word) { h = (h ^ word) * 0x9e3779b97f4a7c15u, h ^= h >> 29; };
    for (const Segment& s : segments_) {
        for (const std::uint64_t word : {s.root.bits(), s.patch.bits(), std::uint64_t{s.vertex_count},
                                         std::uint64_t{s.index_count}, std::uint64_t{s.leaves * 2 + s.detailed}})
            add(word);
        const auto words = [&](const auto* data, std::size_t count) {
            for (std::size_t k = 0; k < count; ++k) add(data[k]);
        };
        for (const SegmentVertex& v : vertices().subspan(s.first_vertex, s.vertex_count)) {
            std::uint64_t word[3];
            std::memcpy(word, &v, sizeof v);
            words(word, 3);
        }
        if (view_.morph)
            for (const MorphVertex& m : morphs().subspan(s.first_vertex, s.vertex_count)) {
                std::uint32_t word[5];
                std::memcpy(word, &m, sizeof m);
                words(word, 5);
            }
        words(indices_.data() + s.first_index, s.index_count);
        words(leaf_levels_.data() + s.first_leaf, s.leaves);
    }
    return h;
}

}  // namespace planet
