#include "planet/bisection/progressive.h"

#include <cassert>

#include "planet/bisection/bisection_state.h"
#include "planet/error.h"

namespace planet {

using Index = Progressive::Index;

namespace {

// Corners of the four children among those of their Split.
constexpr std::array<std::array<std::uint8_t, 3>, 4> child_corners = {{{0, 4, 2}, {4, 1, 2}, {1, 4, 3}, {4, 0, 3}}};

}  // namespace

Progressive::Progressive(PlainMesh base, BisectionRule rule, SideGeometry sides)
    : base_(std::move(base)),
      base_vertices_(static_cast<Index>(base_.vertices.size())),
      rule_(rule),
      sides_(sides),
      places_(base_.vertices.begin(), base_.vertices.end()),
      base_splitter_(base_.triangles.size(), none) {}

void Progressive::set_note(std::string note) {
    if (note.size() > max_note)
        throw Error(Fault::bad_usage, "the note", std::to_string(note.size()) + " bytes",
                    "at most " + std::to_string(max_note));
    note_ = std::move(note);
}

void Progressive::reserve(std::size_t splits) {
    places_.reserve(base_vertices_ + splits);
    splits_.reserve(splits);
}

std::array<Index, 3> Progressive::corners_of_child(Index vertex, Index child) const {
    const auto& corner = split_of(vertex).corner;
    const auto& at = child_corners[child];
    return {corner[at[0]], corner[at[1]], corner[at[2]]};
}

// Without branches on which side of which child it is, which would be guessed wrong every other time.
Progressive::Parent Progressive::parent(Index side) {
    constexpr std::array<std::uint8_t, 5> turn = {0, 1, 2, 0, 1};
    const Index name = side / 3, k = side % 3;
    const auto unless_split = [](Index& splitter) { return splitter == none ? &splitter : nullptr; };
    if (name < roots()) {
        const auto& c = base_.triangles[name];
        return {c[k], c[turn[k + 1]], c[turn[k + 2]], complete, 0, unless_split(base_splitter_[name])};
    }
    const Index i = (name - roots()) / 4, child = (name - roots()) % 4, odd = child % 2;
    if (i >= splits_.size()) return {};
    Split& s = splits_[i];
    const auto& at = child_corners[child];
    const auto kind = static_cast<Kind>(s.kinds >> 2 * child & 3);
    const bool opposite = k == 2 - odd;  // to the vertex that made it
    Index* const splitter =
        (kind == complete) | ((kind != absent) & opposite) ? unless_split(s.splitter[child]) : nullptr;
    return {s.corner[at[k]], s.corner[at[turn[k + 1]]], s.corner[at[turn[k + 2]]], kind, odd, splitter};
}

bool Progressive::link(const SplitRecord& record) {
    // Kinds of a parent's children, by its own, whether it is a second child, and whether it becomes four.
    constexpr unsigned two_halves = half_of_four | half_of_four << 2, neither = 256;
    constexpr unsigned pair_kinds[4][2][2] = {{{0, two_halves}, {0, two_halves}},
                                              {{quarter, neither}, {quarter << 2, neither}},
                                              {{0, two_halves}, {0, two_halves}},
                                              {{absent | absent << 2, neither}, {neither, neither}}};
    Index none_beyond = none;
    const Parent first = parent(record.first);
    const Parent second = record.second != SplitRecord::no_side
                              ? parent(record.second)
                              : Parent{first.b, first.a, none, absent, 0, &none_beyond};
    const bool flipped = (record.flags & SplitRecord::over_flip) != 0;
    const unsigned kinds = pair_kinds[first.kind][first.odd][(record.flags & SplitRecord::first_becomes_four) != 0] |
                           pair_kinds[second.kind][second.odd][(record.flags & SplitRecord::second_becomes_four) != 0]
                               << 4;
    const bool shared = (first.a == second.b) & (first.b == second.a) & (first.splitter != second.splitter);
    const bool alike = ((first.kind == quarter) == flipped) & ((second.kind == quarter) == flipped);
    const bool known = (record.flags & ~record_bits) == 0;
    if (!first.splitter || !second.splitter || !(shared & alike & known) || kinds >= neither) return false;

    const Index v = base_vertices_ + split_count();
    *first.splitter = *second.splitter = v;
    const bool f = flipped;
    splits_.push_back(
        {{f ? second.c : first.a, f ? first.c : first.b, f ? first.a : first.c, f ? first.b : second.c, v},
         {none, none, none, none},
         record.first,
         record.second,
         record.flags,
         static_cast<std::uint8_t>(kinds)});
    return true;
}

std::size_t Progressive::link(std::span<const SplitRecord> records) {
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const SplitRecord& later = records[std::min(i + ahead, records.size() - 1)];
        for (const Index name : {later.first / 3, later.second / 3})
            if (name >= roots() && name < name_count()) __builtin_prefetch(&splits_[(name - roots()) / 4]);
        if (!link(records[i])) return i;
    }
    return records.size();
}

bool Progressive::append(const SplitRecord& record, const glm::dvec3* place) {
    return append(std::span(&record, 1), [&](const glm::dvec3& midpoint) { return place ? *place : midpoint; });
}

SplitSide Progressive::ends(Index vertex) const {
    if (vertex < base_vertices_) return {vertex, vertex};
    return {split_of(vertex).corner[0], split_of(vertex).corner[1]};
}

std::array<Index, 2> Progressive::dependencies(Index vertex) const {
    if (vertex < base_vertices_) return {none, none};
    const Split& s = split_of(vertex);
    const auto maker = [&](Index side) {
        return side == SplitRecord::no_side || side / 3 < roots() ? none : base_vertices_ + (side / 3 - roots()) / 4;
    };
    return {maker(s.first), maker(s.second)};
}

std::array<Index, 4> Progressive::dependents(Index vertex) const {
    if (vertex < base_vertices_) return {none, none, none, none};
    return split_of(vertex).splitter;
}

std::array<Progressive::Child, 2> Progressive::halves(Index name) const {
    const Index v = splitter(name), first = split_of(v).first / 3 == name ? 0 : 2;
    const Index child = roots() + 4 * (v - base_vertices_) + first;
    return {{{child, corners_of_child(v, first)}, {child + 1, corners_of_child(v, first + 1)}}};
}

bool Progressive::becomes_four(Index name) const {
    const Split& s = split_of(splitter(name));
    return (s.flags & (s.first / 3 == name ? SplitRecord::first_becomes_four : SplitRecord::second_becomes_four)) != 0;
}

std::array<Progressive::Child, 4> Progressive::four(Index name) const {
    const auto half = halves(name);
    const Index c1 = splitter(name), b1 = splitter(half[0].name), a1 = splitter(half[1].name);
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
