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

bool longer(const Leaf& t, int i, int j) {
    const auto a = t.squared[static_cast<std::size_t>(i)], b = t.squared[static_cast<std::size_t>(j)];
    return a != b ? a > b : t.ages[i] < t.ages[j];
}

int longest_side(const Leaf& t) {
    const int i = longer(t, 1, 0) ? 1 : 0;
    return longer(t, 2, i) ? 2 : i;
}

Leaf turned(const Leaf& t, int first) {
    Leaf out = t;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t from = (k + static_cast<std::size_t>(first)) % 3;
        out.squared[k] = t.squared[from];
        out.corner[k] = t.corner[from];
        out.beyond[k] = t.beyond[from];
    }
    out.ages = t.ages.turned(first);
    out.turn = static_cast<std::uint8_t>((t.turn + first) % 3);
    return out;
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

// The side from one vertex to another.
std::size_t side_between(const Leaf& t, std::uint32_t from, std::uint32_t to) {
    const std::size_t k = t.corner[0] == from ? 0 : t.corner[1] == from ? 1 : 2;
    assert(t.corner[k] == from && t.corner[(k + 1) % 3] == to);
    (void)to;
    return k;
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
        const Leaf made = turned(leaf, longest_side(leaf));
        if (!(length(cross(p[1] - p[0], p[2] - p[0])) > flat * made.squared[0]))
            throw Error(Fault::bad_data, "the mesh",
                        "triangle " + std::to_string(t) + " (vertices " + std::to_string(leaf.corner[0]) + ", " +
                            std::to_string(leaf.corner[1]) + ", " + std::to_string(leaf.corner[2]) + ") has no area" +
                            (options_.sides == SideGeometry::plan ? " in plan" : ""),
                        "triangles with one");
        leaves_.push_back(made);
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
        const glm::dvec3 placed = options_.place((placed_[a] + placed_[b]) * 0.5), &middle = flat_.back();
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

void LeafMesh::relink(Index outer, Index from, Index to, Index now) {
    if (outer == none) return;
    Leaf& leaf = leaves_[outer];
    leaf.beyond[side_between(leaf, from, to)] = now;
}

void LeafMesh::put(Index slot, Leaf made, int longest) {
    leaves_[slot] = turned(made, longest);
    note_changed(slot);
}

// Replaces a leaf by its halves. Their links across ab are left to the caller.
LeafMesh::Halves LeafMesh::halve(Index slot, Index v, Index name) {
    const Leaf t = leaves_[slot];
    const auto [a, b, c] = t.corner;
    const auto other = static_cast<Index>(leaves_.size());
    const double m = median(t, v), quarter = t.squared[0] / 4;
    const bool four =
        options_.rule == BisectionRule::modified && t.kind == LeafKind::complete && becomes_four(t.squared, m);

    Leaf first{}, second{};
    first.squared = {quarter, m, t.squared[2]};
    first.corner = {a, v, c};
    first.beyond = {none, other, t.beyond[2]};
    first.ages = t.ages[0] < t.ages[2] ? SideAges(0, 2, 1) : SideAges(1, 2, 0);
    first.name = name;
    second.squared = {quarter, t.squared[1], m};
    second.corner = {v, b, c};
    second.beyond = {none, t.beyond[1], slot};
    second.ages = t.ages[0] < t.ages[1] ? SideAges(0, 1, 2) : SideAges(1, 0, 2);
    second.name = name + 1;
    first.base = second.base = t.base;
    if (four) {
        first.kind = LeafKind::half_first;
        second.kind = LeafKind::half_second;
        first.parent_ages = second.parent_ages = t.ages;
    } else if (t.kind == LeafKind::half_first) {
        first.kind = LeafKind::quarter;
        first.parent_ages = t.parent_ages;
    } else if (t.kind == LeafKind::half_second) {
        second.kind = LeafKind::quarter;
        second.parent_ages = t.parent_ages;
    }
    // Quarters are split by nothing but what splits C'C, which is ca of (C, B', C') and bc of (A', C, C').
    const int first_longest = first.kind == LeafKind::complete ? longest_side(first) : 2;
    const int second_longest = second.kind == LeafKind::complete ? longest_side(second) : 1;
    leaves_.emplace_back();
    put(slot, first, first_longest);
    put(other, second, second_longest);
    relink(t.beyond[1], c, b, other);
    return {slot, other, (3 - first_longest) % 3, (3 - second_longest) % 3, four};
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

void LeafMesh::flip_if_both(Index half_slot, Index new_slot, double squared_ab) {
    const Index q = leaves_[half_slot].kind == LeafKind::quarter ? half_slot : new_slot;
    const Index r = leaves_[q].beyond[0];
    if (leaves_[q].kind != LeafKind::quarter || leaves_[r].kind != LeafKind::quarter) return;
    note_changed(r);
    // B' of the quarter (C', C, B') is on the left of C'C.
    q == half_slot ? flip(q, r, squared_ab) : flip(r, q, squared_ab);
}

void LeafMesh::split_terminal(Index slot) {
    const Leaf t = leaves_[slot];
    const Index n_slot = t.beyond[0];
    assert(n_slot == none || mutual(t, leaves_[n_slot]));
    const auto name = static_cast<Index>(base_triangles_ + 4 * (flat_.size() - base_vertices_));
    changed_count_ = 0;
    const Index v = insert_vertex(t.corner[0], t.corner[1]);
    SplitRecord record{.first = 3 * t.name + t.turn};
    const Leaf n = n_slot == none ? Leaf{} : leaves_[n_slot];
    const Halves mine = halve(slot, v, name);
    if (mine.becomes_four) record.flags |= SplitRecord::first_becomes_four;
    if (t.flipped) record.flags |= SplitRecord::over_flip;
    if (n_slot != none) {
        const Halves theirs = halve(n_slot, v, name + 2);
        record.second = 3 * n.name + n.turn;
        if (theirs.becomes_four) record.flags |= SplitRecord::second_becomes_four;
        const auto link = [&](Index x, int i, Index y, int j) {
            leaves_[x].beyond[static_cast<std::size_t>(i)] = y;
            leaves_[y].beyond[static_cast<std::size_t>(j)] = x;
        };
        link(mine.first, mine.av, theirs.second, theirs.vb);
        link(mine.second, mine.vb, theirs.first, theirs.av);
        if (n.kind == LeafKind::half_first || n.kind == LeafKind::half_second)
            flip_if_both(theirs.first, theirs.second, n.kind == LeafKind::half_first ? n.squared[1] : n.squared[2]);
    }
    if (t.kind == LeafKind::half_first || t.kind == LeafKind::half_second)
        flip_if_both(mine.first, mine.second, t.kind == LeafKind::half_first ? t.squared[1] : t.squared[2]);
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
