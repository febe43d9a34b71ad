#pragma once
// The leaves of a bisection, their links, and the split of a side that is the longest of both its triangles: all that
// changes the mesh. Which side to split is for others to say.
//
//              c                  corners a, b, c; side 0 is ab, the longest, 1 is bc, 2 is ca. A split at v leaves
//             / \                 (a, v, c) in the same slot and (v, b, c) in a new one, each turned until its
//            /   \                longest side is side 0.
//           a--v--b
//
// Lengths are not measured again: halves of a side have a quarter of its squared length, and of the three sides within
// one that becomes four each has a quarter of that to which it is parallel. So similar triangles have equal numbers. A median's
// length follows from the sides, or from the vertices where that would cancel.

#include <span>
#include <vector>

#include "planet/bisection/huge_pages.h"
#include "planet/bisection/progressive.h"
#include "planet/bisection/shape.h"

namespace planet {

enum class LeafKind : std::uint8_t {
    complete,
    half_first,   ///< (C, A, C') of a triangle that becomes four
    half_second,  ///< (B, C, C')
    quarter,      ///< (C', C, B') or (C, C', A')
};

/// Which of equally long sides is longer: by side, two bits each, 0 the oldest.
class SideAges {
  public:
    SideAges() = default;
    SideAges(unsigned ab, unsigned bc, unsigned ca) : bits_(static_cast<std::uint8_t>(ab | bc << 2 | ca << 4)) {}
    unsigned operator[](unsigned side) const { return bits_ >> (2 * side) & 3u; }
    /// With side `first` as side 0.
    SideAges turned(unsigned first) const {
        SideAges out;
        out.bits_ = static_cast<std::uint8_t>((bits_ >> 2 * first | bits_ << (6 - 2 * first)) & 63);
        return out;
    }

  private:
    std::uint8_t bits_ = 0;
};

struct alignas(64) Leaf {
    SquaredSides squared;  ///< of sides 0, 1, 2
    std::array<std::uint32_t, 3> corner;
    std::array<std::uint32_t, 3> beyond;  ///< leaf beyond each side, or none
    std::uint32_t name;                   ///< progressive.h
    std::uint32_t base;                   ///< base triangle
    LeafKind kind;
    std::uint8_t turn;  ///< corner 0 is corner `turn` of the triangle that the name means, before C'C gave way
    bool flipped;       ///< side 0 is A'B' in place of C'C
    SideAges ages;
    SideAges parent_ages;  ///< of a half or quarter: those of AB, BC, CA
};
static_assert(sizeof(Leaf) == 64, "one line of the cache");

class LeafMesh {
  public:
    using Index = std::uint32_t;
    static constexpr Index none = 0xffffffffu;

    /// Throws as Bisection does.
    LeafMesh(const PlainMesh& base, const BisectionOptions& options);

    const Leaf& operator[](Index leaf) const { return leaves_[leaf]; }
    std::size_t size() const { return leaves_.size(); }
    std::size_t vertex_count() const { return flat_.size(); }
    const std::vector<std::array<Index, 3>>& base_corners() const { return base_corners_; }
    std::size_t base_vertices() const { return base_vertices_; }
    std::size_t base_triangles() const { return base_triangles_; }
    std::size_t base_border() const { return base_border_; }  ///< sides of one triangle
    const BisectionOptions& options() const { return options_; }

    const glm::dvec3& place(Index v) const { return placed_.empty() ? flat_[v] : placed_[v]; }
    bool has_placement() const { return static_cast<bool>(options_.place); }
    std::span<const glm::dvec3> places() const { return placed_.empty() ? flat_ : placed_; }
    /// A vertex where sides are judged: a midpoint, its height 0 in plan.
    glm::dvec3 judged(Index v) const {
        return options_.sides == SideGeometry::plan ? glm::dvec3(flat_[v].x, flat_[v].y, 0) : flat_[v];
    }
    std::span<const float> attributes() const { return attributes_; }
    std::size_t attribute_width() const { return attribute_width_; }
    std::span<const SplitRecord> records() const { return records_; }

    /// Whether two leaves share the longest sides of both.
    static bool mutual(const Leaf& t, const Leaf& n) {
        return n.corner[0] == t.corner[1] && n.corner[1] == t.corner[0];
    }
    /// The leaf that is to be split first for a leaf to be split: its longest side is that of both its triangles.
    Index terminal(Index t) const;
    bool can_halve(double squared) const { return squared > shortest2_; }
    double finest_squared() const { return shortest2_; }
    /// Splits the longest side of a terminal leaf. O(1).
    void split_terminal(Index t);
    /// Leaves that the last split made or changed, at most eight.
    std::span<const Index> changed() const { return {changed_.data(), changed_count_}; }

    void reserve(std::size_t leaves);
    std::size_t bytes() const;

    /// Fetch into the cache what the split of a leaf will need: first the leaf, then what lies around it, then what lies
    /// around its neighbour, then what a flip there relinks. Inlined by force: GCC 12 takes calls that do nothing but fetch for
    /// calls that do nothing, and leaves them out.
    [[gnu::always_inline]] void prefetch_leaf(Index t) const { __builtin_prefetch(&leaves_[t]); }
    [[gnu::always_inline]] void prefetch_around(Index t) const {
        const Leaf& leaf = leaves_[t];
        for (const Index n : {leaf.beyond[0], leaf.beyond[1], sibling(leaf)})
            if (n != none) prefetch_leaf(n);
        for (const Index v : {leaf.corner[0], leaf.corner[1]}) {
            __builtin_prefetch(&flat_[v].x);
            __builtin_prefetch(&flat_[v].z);
        }
    }
    [[gnu::always_inline]] void prefetch_beyond(Index t) const {
        const Leaf& leaf = leaves_[t];
        prefetch_beyond_sibling(leaf);
        if (leaf.beyond[0] == none) return;
        const Leaf& n = leaves_[leaf.beyond[0]];
        for (const Index outer : {n.beyond[1], sibling(n)})
            if (outer != none) prefetch_leaf(outer);
    }
    [[gnu::always_inline]] void prefetch_flip_beyond(Index t) const {
        const Index n = leaves_[t].beyond[0];
        if (n != none) prefetch_beyond_sibling(leaves_[n]);
    }

  private:
    /// What a leaf is made from, its longest side not yet side 0.
    struct Half {
        SquaredSides squared;
        std::array<Index, 3> corner, beyond;
        SideAges ages;
        unsigned longest;
    };

    /// Of a half or quarter: what is across C'C, always there. Of others: what is beyond side 1, or none.
    static Index sibling(const Leaf& t) {
        constexpr std::array<std::uint8_t, 4> side = {1, 2, 1, 0};  // by kind
        return t.beyond[side[static_cast<std::size_t>(t.kind)]];
    }
    [[gnu::always_inline]] void prefetch_beyond_sibling(const Leaf& leaf) const {
        if (leaf.kind == LeafKind::complete) return;
        const Index outer = leaves_[sibling(leaf)].beyond[1];
        if (outer != none) prefetch_leaf(outer);
    }
    Index insert_vertex(Index a, Index b);
    double median(const Leaf& t, Index v) const;
    bool halve(Index slot, Index other, Index v, Index name, Index beyond_av, Index beyond_vb);
    void put(Index slot, const Half& half, Index name, Index base, LeafKind kind, SideAges parent_ages);
    void relink(Index outer, Index from, Index to, Index now);
    void flip(Index first, Index second, double squared_ab);
    void flip_if_both(const Leaf& half, Index first, Index second);
    void note_changed(Index t) { changed_[changed_count_++] = t; }

    BisectionOptions options_;
    std::size_t base_vertices_, base_triangles_, base_border_ = 0;
    std::vector<std::array<Index, 3>> base_corners_;
    LargeArray<Leaf> leaves_;
    LargeArray<glm::dvec3> flat_;    ///< midpoints
    LargeArray<glm::dvec3> placed_;  ///< empty if places are midpoints
    std::vector<float> attributes_;
    std::size_t attribute_width_;
    std::vector<SplitRecord> records_;
    double shortest2_ = 0;  ///< squares of sides too short to halve
    std::array<Index, 8> changed_{};
    std::size_t changed_count_ = 0;
};

/// Links of a base mesh: by triangle and side, the triangle beyond, or LeafMesh::none. Throws Error(bad_data) as Bisection
/// does.
std::vector<std::array<std::uint32_t, 3>> base_links(const PlainMesh& base);

}  // namespace planet
