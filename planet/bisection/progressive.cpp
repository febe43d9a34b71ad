#include "planet/bisection/progressive.h"

#include <cassert>

#include "planet/bisection/bisection_state.h"
#include "planet/error.h"

namespace planet {

using Index = Progressive::Index;

Progressive::Progressive(PlainMesh base, BisectionRule rule, SideGeometry sides)
    : base_(std::move(base)),
      base_vertices_(static_cast<Index>(base_.vertices.size())),
      rule_(rule),
      sides_(sides),
      places_(base_.vertices.begin(), base_.vertices.end()),
      splitter_(base_.triangles.size(), none) {}

void Progressive::set_note(std::string note) {
    if (note.size() > max_note)
        throw Error(Fault::bad_usage, "the note", std::to_string(note.size()) + " bytes",
                    "at most " + std::to_string(max_note));
    note_ = std::move(note);
}

void Progressive::reserve(std::size_t splits) {
    places_.reserve(base_vertices_ + splits);
    splits_.reserve(splits);
    splitter_.reserve(base_.triangles.size() + 4 * splits);
}

std::array<Index, 3> Progressive::corners_of_child(Index vertex, int child) const {
    const Split& s = splits_[vertex - base_vertices_];
    const bool pair = child >= 2;
    const Index from = pair ? s.b : s.a, to = pair ? s.a : s.b, across = pair ? s.d : s.c;
    return child % 2 == 0 ? std::array{from, vertex, across} : std::array{vertex, to, across};
}

// std::nullopt for a side that no triangle has, or whose triangle is split already.
std::optional<Progressive::Parent> Progressive::parent(Index side) const {
    constexpr std::array<std::uint8_t, 5> turn = {0, 1, 2, 0, 1};
    const Index name = side / 3, k = side % 3, roots = static_cast<Index>(base_.triangles.size());
    if (name >= splitter_.size() || splitter_[name] != none) return std::nullopt;
    if (name < roots) {
        const auto& c = base_.triangles[name];
        return Parent{c[k], c[turn[k + 1]], c[turn[k + 2]], false, -1};
    }
    const Index maker = base_vertices_ + (name - roots) / 4;
    const int child = static_cast<int>((name - roots) & 3), pair = child / 2;
    const Split& s = splits_[maker - base_vertices_];
    const Index apex = pair == 0 ? s.c : s.d;
    if (apex == none) return std::nullopt;
    const auto c = corners_of_child(maker, child);
    Parent p{c[k], c[turn[k + 1]], c[turn[k + 2]], (s.flags & quarter_bits(pair, child % 2)) != 0, -1};
    const unsigned four = pair == 0 ? SplitRecord::first_becomes_four : SplitRecord::second_becomes_four;
    if ((s.flags & four) != 0) {  // a half: only its side opposite to C' can be split, and the child at C is a quarter
        if (p.c != maker) return std::nullopt;
        p.quarter_child = p.a == apex ? 0 : 1;
    } else if (p.quarter && p.c != maker) {  // only C'C
        return std::nullopt;
    }
    return p;
}

bool Progressive::append(const SplitRecord& record, const glm::dvec3* place) {
    const auto first = parent(record.first);
    if (!first || (record.flags & ~record_bits) != 0) return false;
    const bool inner = record.second != SplitRecord::no_side;
    const auto second = inner ? parent(record.second) : std::nullopt;
    if (inner && (!second || record.first / 3 == record.second / 3 || second->a != first->b || second->b != first->a))
        return false;
    const bool flipped = (record.flags & SplitRecord::over_flip) != 0;
    if (first->quarter != flipped || (inner ? second->quarter != flipped : flipped)) return false;
    Split s{first->a, first->b, first->c, inner ? second->c : none, record.first, record.second, record.flags};
    if (flipped) s = {s.d, s.c, s.a, s.b, s.first, s.second, s.flags};
    const auto mark_quarter = [&](const Parent& p, int pair, unsigned four) {
        if (p.quarter_child < 0) return true;
        s.flags |= static_cast<std::uint8_t>(quarter_bits(pair, p.quarter_child));
        return (record.flags & four) == 0;
    };
    if (!mark_quarter(*first, 0, SplitRecord::first_becomes_four)) return false;
    if (inner ? !mark_quarter(*second, 1, SplitRecord::second_becomes_four)
              : (record.flags & SplitRecord::second_becomes_four) != 0)
        return false;

    const Index v = vertex_count();
    places_.push_back(place ? *place : midpoint(s.a, s.b));
    splits_.push_back(s);
    splitter_[record.first / 3] = v;
    if (inner) splitter_[record.second / 3] = v;
    splitter_.resize(splitter_.size() + 4, none);
    return true;
}

void Progressive::prefetch_parents(const SplitRecord& record) const {
    const auto roots = static_cast<Index>(base_.triangles.size());
    for (const Index side : {record.first, record.second}) {
        const Index name = side / 3;
        if (name >= splitter_.size()) continue;
        __builtin_prefetch(&splitter_[name]);
        if (name >= roots) __builtin_prefetch(&splits_[(name - roots) / 4]);
    }
}

void Progressive::prefetch_ends(const SplitRecord& record) const {
    const auto roots = static_cast<Index>(base_.triangles.size());
    const Index name = record.first / 3;
    if (name < roots || name >= splitter_.size()) return;
    const Split& s = splits_[(name - roots) / 4];
    for (const Index v : {s.a, s.b, s.c, s.d})
        if (v != none) {
            __builtin_prefetch(&places_[v].x);
            __builtin_prefetch(&places_[v].z);
        }
}

SplitSide Progressive::ends(Index vertex) const {
    if (vertex < base_vertices_) return {vertex, vertex};
    return {splits_[vertex - base_vertices_].a, splits_[vertex - base_vertices_].b};
}

std::array<Index, 2> Progressive::dependencies(Index vertex) const {
    if (vertex < base_vertices_) return {none, none};
    const Split& s = splits_[vertex - base_vertices_];
    const auto roots = static_cast<Index>(base_.triangles.size());
    const auto maker = [&](Index side) {
        return side == SplitRecord::no_side || side / 3 < roots ? none : base_vertices_ + (side / 3 - roots) / 4;
    };
    return {maker(s.first), maker(s.second)};
}

std::array<Index, 4> Progressive::dependents(Index vertex) const {
    if (vertex < base_vertices_) return {none, none, none, none};
    const std::size_t name = base_.triangles.size() + 4 * std::size_t{vertex - base_vertices_};
    return {splitter_[name], splitter_[name + 1], splitter_[name + 2], splitter_[name + 3]};
}

std::array<Progressive::Child, 2> Progressive::halves(Index name) const {
    const Index v = splitter_[name], i = v - base_vertices_;
    const int pair = splits_[i].first / 3 == name ? 0 : 1;
    const Index child = static_cast<Index>(base_.triangles.size()) + 4 * i + 2 * static_cast<Index>(pair);
    return {{{child, corners_of_child(v, 2 * pair)}, {child + 1, corners_of_child(v, 2 * pair + 1)}}};
}

bool Progressive::becomes_four(Index name) const {
    const Split& s = splits_[splitter_[name] - base_vertices_];
    return (s.flags & (s.first / 3 == name ? SplitRecord::first_becomes_four : SplitRecord::second_becomes_four)) != 0;
}

std::array<Progressive::Child, 4> Progressive::four(Index name) const {
    const auto half = halves(name);
    const Index c1 = splitter_[name], b1 = splitter_[half[0].name], a1 = splitter_[half[1].name];
    const Index c = half[0].corners[2];
    auto at_a = halves(half[0].name), at_b = halves(half[1].name);
    // Of each half, the quarter is the child with C.
    const auto has_c = [&](const Child& x) { return x.corners[0] == c || x.corners[1] == c || x.corners[2] == c; };
    if (has_c(at_a[0])) std::swap(at_a[0], at_a[1]);
    if (has_c(at_b[0])) std::swap(at_b[0], at_b[1]);
    return {{at_a[0], at_b[0], {at_b[1].name, {b1, a1, c}}, {at_a[1].name, {a1, b1, c1}}}};
}

std::vector<float> Progressive::attributes(Index count) const {
    const std::size_t width = base_.attribute_width;
    std::vector<float> out(base_.attributes);
    out.resize(width * count);
    for (Index v = base_vertices_; v < count; ++v) {
        const auto [a, b] = ends(v);
        for (std::size_t i = 0; i < width; ++i) out[v * width + i] = (out[a * width + i] + out[b * width + i]) / 2;
    }
    return out;
}

PlainMesh Progressive::prefix(Index splits) const {
    Selection selection(*this);
    selection.set_prefix(splits);
    return selection.mesh();
}

Progressive Bisection::progressive() const {
    const LeafMesh& leaves = state_->mesh;
    const auto first_of = [&](const auto& all, std::size_t count) {
        return std::vector(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    };
    PlainMesh base;
    base.vertices = first_of(leaves.places(), leaves.base_vertices());
    base.triangles = leaves.base_corners();
    base.attribute_width = leaves.attribute_width();
    base.attributes = first_of(leaves.attributes(), leaves.base_vertices() * base.attribute_width);
    Progressive out(std::move(base), leaves.options().rule, leaves.options().sides);
    out.reserve(leaves.records().size());
    for (std::size_t i = 0; i < leaves.records().size(); ++i) {
        const glm::dvec3 place = leaves.place(static_cast<Index>(leaves.base_vertices() + i));
        [[maybe_unused]] const bool fits = out.append(leaves.records()[i], &place);
        assert(fits);
    }
    return out;
}

}  // namespace planet
