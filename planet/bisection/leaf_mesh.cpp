#include "planet/bisection/leaf_mesh.h"

#include <cassert>
#include <cfloat>
#include <utility>

#include "planet/error.h"

namespace planet {

namespace {

// Medians shorter than this part of the longest side, squared, are measured.
constexpr double cancels = 1e-4;
// Longest side over height at which a triangle has no area to speak of.
constexpr double flat = 1e-14;

// Without branches, which would be guessed wrong every other time.
unsigned longest_side(const SquaredSides& s, SideAges ages) {
    const auto longer = [&](unsigned i, unsigned j) { return (s[i] > s[j]) | ((s[i] == s[j]) & (ages[i] < ages[j])); };
    const unsigned i = longer(1, 0) ? 1 : 0;
    return longer(2, i) ? 2 : i;
}

// The sides of base triangles by age: that with the lower vertex numbers is older.
SideAges base_ages(const std::array<std::uint32_t, 3>& corner) {
    std::array<std::pair<std::uint32_t, std::uint32_t>, 3> ends;
    for (std::size_t k = 0; k < 3; ++k) ends[k] = std::minmax(corner[k], corner[(k + 1) % 3]);
    const auto age = [&](std::size_t k) {
        return static_cast<unsigned>(ends[(k + 1) % 3] < ends[k]) + static_cast<unsigned>(ends[(k + 2) % 3] < ends[k]);
    };
    return {age(0), age(1), age(2)};
}

}  // namespace

LeafMesh::LeafMesh(const PlainMesh& base, const BisectionOptions& options)
    : options_(options),
      base_vertices_(base.vertices.size()),
      base_triangles_(base.triangles.size()),
      base_corners_(base.triangles),
      flat_(base.vertices.begin(), base.vertices.end()),
      attributes_(base.attributes),
      attribute_width_(base.attribute_width) {
    const auto links = base_links(base);
    if (options_.place) placed_ = flat_;
    double largest = 0;
    for (const glm::dvec3& p : flat_) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    shortest2_ = std::max(std::ldexp(largest * largest, -80), 1e-280);
    leaves_.reserve(base_triangles_);
    for (std::size_t t = 0; t < base_triangles_; ++t) {
        Leaf leaf{};
        leaf.corner = base.triangles[t];
        leaf.beyond = links[t];
        for (const Index n : links[t]) base_border_ += n == none;
        leaf.name = leaf.base = static_cast<Index>(t);
        leaf.ages = base_ages(leaf.corner);
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = judged(leaf.corner[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 d = p[(k + 1) % 3] - p[k];
            leaf.squared[k] = dot(d, d);
        }
        if (!(length(cross(p[1] - p[0], p[2] - p[0])) >
              flat * *std::max_element(leaf.squared.begin(), leaf.squared.end())))
            throw Error(Fault::bad_data, "the mesh",
                        "triangle " + std::to_string(t) + " (vertices " + std::to_string(leaf.corner[0]) + ", " +
                            std::to_string(leaf.corner[1]) + ", " + std::to_string(leaf.corner[2]) + ") has no area" +
                            (options_.sides == SideGeometry::plan ? " in plan" : ""),
                        "triangles with one");
        leaves_.emplace_back();
        put(static_cast<Index>(t),
            {leaf.squared, leaf.corner, leaf.beyond, leaf.ages, longest_side(leaf.squared, leaf.ages)}, leaf.name,
            leaf.base, LeafKind::complete, {});
        changed_count_ = 0;
    }
}

LeafMesh::Index LeafMesh::terminal(Index t) const {
    for (;;) {
        const Index n = leaves_[t].beyond[0];
        if (n == none || mutual(leaves_[t], leaves_[n])) return t;
        t = n;
    }
}

LeafMesh::Index LeafMesh::insert_vertex(Index a, Index b) {
    const auto v = static_cast<Index>(flat_.size());
    flat_.push_back((flat_[a] + flat_[b]) * 0.5);
    if (options_.place) {
        const glm::dvec3 placed = options_.place(placed_[a], placed_[b]), &middle = flat_.back();
        placed_.push_back(options_.sides == SideGeometry::plan ? glm::dvec3(middle.x, middle.y, placed.z) : placed);
    }
    for (std::size_t i = 0; i < attribute_width_; ++i)
        attributes_.push_back((attributes_[a * attribute_width_ + i] + attributes_[b * attribute_width_ + i]) / 2);
    return v;
}

// The squared length of the new side from the last corner. In halves of a triangle that becomes four it is parallel to a side of that, half
// as long; the other half, split or not, knows it.
double LeafMesh::median(const Leaf& t, Index v) const {
    if (t.kind == LeafKind::half_first) {
        const Leaf& other = leaves_[t.beyond[2]];
        return other.kind == LeafKind::half_second ? other.squared[0] / 4 : other.squared[2];
    }
    if (t.kind == LeafKind::half_second) {
        const Leaf& other = leaves_[t.beyond[1]];
        return other.kind == LeafKind::half_first ? other.squared[0] / 4 : other.squared[1];
    }
    const double m = squared_median(t.squared);
    if (m > cancels * t.squared[0]) return m;
    const glm::dvec3 d = judged(t.corner[2]) - judged(v);
    return std::max(dot(d, d), DBL_MIN);
}

void LeafMesh::relink(Index outer, Index from, [[maybe_unused]] Index to, Index now) {
    if (outer == none) return;
    Leaf& leaf = leaves_[outer];
    const std::size_t k = leaf.corner[1] == from ? 1 : leaf.corner[2] == from ? 2 : 0;
    assert(leaf.corner[k] == from && leaf.corner[(k + 1) % 3] == to);
    leaf.beyond[k] = now;
}

void LeafMesh::put(Index slot, const Half& half, Index name, Index base, LeafKind kind, SideAges parent_ages) {
    constexpr std::array<std::uint8_t, 5> turn = {0, 1, 2, 0, 1};
    const std::size_t i = half.longest, j = turn[i + 1], k = turn[i + 2];
    Leaf& leaf = leaves_[slot];
    leaf.squared = {half.squared[i], half.squared[j], half.squared[k]};
    leaf.corner = {half.corner[i], half.corner[j], half.corner[k]};
    leaf.beyond = {half.beyond[i], half.beyond[j], half.beyond[k]};
    leaf.name = name;
    leaf.base = base;
    leaf.kind = kind;
    leaf.turn = static_cast<std::uint8_t>(i);
    leaf.flipped = false;
    leaf.ages = half.ages.turned(half.longest);
    leaf.parent_ages = parent_ages;
    note_changed(slot);
}

// Replaces a leaf by its halves (a, v, c), in its slot, and (v, b, c). @return whether it becomes four
bool LeafMesh::halve(Index slot, Index other, Index v, Index name, Index beyond_av, Index beyond_vb) {
    const Leaf t = leaves_[slot];
    const auto [a, b, c] = t.corner;
    const double m = median(t, v), quarter = t.squared[0] / 4;
    const bool complete = t.kind == LeafKind::complete;
    const bool four = options_.rule == BisectionRule::modified && complete && becomes_four(t.squared, m);
    Half first{{quarter, m, t.squared[2]}, {a, v, c}, {beyond_av, other, t.beyond[2]}, {}, 2};
    Half second{{quarter, t.squared[1], m}, {v, b, c}, {beyond_vb, t.beyond[1], slot}, {}, 1};
    first.ages = t.ages[0] < t.ages[2] ? SideAges(0, 2, 1) : SideAges(1, 2, 0);
    second.ages = t.ages[0] < t.ages[1] ? SideAges(0, 1, 2) : SideAges(1, 0, 2);
    // The longest sides of halves are sides of the triangle; quarters are split by nothing but what splits C'C, which is ca of
    // (C, B', C') and bc of (A', C, C').
    LeafKind first_kind = LeafKind::complete, second_kind = LeafKind::complete;
    if (four) {
        first_kind = LeafKind::half_first;
        second_kind = LeafKind::half_second;
    } else {
        if (t.kind == LeafKind::half_first) first_kind = LeafKind::quarter;
        if (t.kind == LeafKind::half_second) second_kind = LeafKind::quarter;
        if (first_kind == LeafKind::complete) first.longest = longest_side(first.squared, first.ages);
        if (second_kind == LeafKind::complete) second.longest = longest_side(second.squared, second.ages);
    }
    const SideAges parent_ages = complete ? t.ages : t.parent_ages;
    put(slot, first, name, t.base, first_kind, parent_ages);
    put(other, second, name + 1, t.base, second_kind, parent_ages);
    relink(t.beyond[1], c, b, other);
    return four;
}

// Once both quarters at C'C are there, that gives way to A'B':
//
//            C                 C            first   (C', C, B')  ->  (A', B', C')
//           /|\               / \           second  (C, C', A')  ->  (B', A', C)
//         B' | A'    ->     B'---A'
//           \|/               \ /           A'B' is as old as AB, to which it is parallel: it must be the longest side of both even
//            C'                C'           where AB is longest by age alone.
void LeafMesh::flip(Index first, Index second, double squared_ab) {
    const Leaf q = leaves_[first], r = leaves_[second];
    assert(q.kind == LeafKind::quarter && r.kind == LeafKind::quarter && mutual(q, r));
    const Index c1 = q.corner[0], c = q.corner[1], b1 = q.corner[2], a1 = r.corner[2];
    Leaf low = q, high = r;
    low.squared = {squared_ab, q.squared[2], r.squared[1]};
    low.corner = {a1, b1, c1};
    low.beyond = {second, q.beyond[2], r.beyond[1]};
    low.ages = {0, 1, 2};
    high.squared = {squared_ab, r.squared[2], q.squared[1]};
    high.corner = {b1, a1, c};
    high.beyond = {first, r.beyond[2], q.beyond[1]};
    high.ages = r.parent_ages;
    low.kind = high.kind = LeafKind::complete;
    low.flipped = high.flipped = true;
    leaves_[first] = low;
    leaves_[second] = high;
    relink(low.beyond[2], a1, c1, first);
    relink(high.beyond[2], b1, c, second);
}

// @param half what was split into the two leaves
void LeafMesh::flip_if_both(const Leaf& half, Index first, Index second) {
    const bool is_first = half.kind == LeafKind::half_first;
    const Index q = is_first ? first : second, r = leaves_[q].beyond[0];
    if (leaves_[r].kind != LeafKind::quarter) return;
    note_changed(r);
    const double squared_ab = is_first ? half.squared[1] : half.squared[2];
    is_first ? flip(q, r, squared_ab) : flip(r, q, squared_ab);
}

void LeafMesh::split_terminal(Index slot) {
    const Leaf t = leaves_[slot];
    const Index n_slot = t.beyond[0];
    const bool inner = n_slot != none;
    assert(!inner || mutual(t, leaves_[n_slot]));
    const Leaf n = inner ? leaves_[n_slot] : Leaf{};
    const auto name = static_cast<Index>(base_triangles_ + 4 * (flat_.size() - base_vertices_));
    const auto other = static_cast<Index>(leaves_.size()), n_other = inner ? other + 1 : none;
    const Index v = insert_vertex(t.corner[0], t.corner[1]);
    leaves_.resize(leaves_.size() + (inner ? 2 : 1));
    changed_count_ = 0;
    SplitRecord record{3 * t.name + t.turn, SplitRecord::no_side, 0};
    if (halve(slot, other, v, name, n_other, n_slot)) record.flags |= SplitRecord::first_becomes_four;
    if (t.flipped) record.flags |= SplitRecord::over_flip;
    if (inner) {
        record.second = 3 * n.name + n.turn;
        if (halve(n_slot, n_other, v, name + 2, other, slot)) record.flags |= SplitRecord::second_becomes_four;
        if (n.kind != LeafKind::complete) flip_if_both(n, n_slot, n_other);
    }
    if (t.kind != LeafKind::complete) flip_if_both(t, slot, other);
    records_.push_back(record);
}

void LeafMesh::reserve(std::size_t leaves) {
    leaves_.reserve(leaves);
    const std::size_t more = (leaves - std::min(leaves, leaves_.size())) / 2 + 1;
    flat_.reserve(flat_.size() + more);
    if (options_.place) placed_.reserve(placed_.size() + more);
    attributes_.reserve(attributes_.size() + more * attribute_width_);
    records_.reserve(records_.size() + more);
}

std::size_t LeafMesh::bytes() const {
    return leaves_.capacity() * sizeof(Leaf) + base_corners_.capacity() * sizeof(base_corners_[0]) +
           (flat_.capacity() + placed_.capacity()) * sizeof(glm::dvec3) + attributes_.capacity() * sizeof(float) +
           records_.capacity() * sizeof(SplitRecord);
}

}  // namespace planet
