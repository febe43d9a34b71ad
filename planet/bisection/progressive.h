#pragma once
// A bisected mesh as a sequence of split records: any prefix is a conforming mesh, and so is any set of vertices that
// holds the dependencies of each.
//
//     triangle names     0 .. T - 1 the base triangles; T + 4 i + (0..3) the children that vertex V + i makes:
//
//              c                 a vertex v on the side a-b of the triangles abc and bad: children
//             /|\                    0 (a, v, c)   1 (v, b, c)   of the first parent
//            /0|1\                   2 (b, v, d)   3 (v, a, d)   of the second one, if the side is not on the border
//           a--v--b
//            \3|2/               A record is the names of v's two parents, the sides that v splits, and three bits: it is
//             \|/                decoded, and undone, in O(1).
//              d
//
// Dependencies: a vertex depends on those that made its parents, at most two. (The paper has it depend on the "opposite
// vertex", which need not have made the triangle: subsets closed under that rule can be broken meshes.) In a triangle marked
// as one that becomes four, the quarters C'CB' and C'CA' lose C'C to A'B' as soon as both are there: the names then stand for
// the two triangles at A'B'. The middle of A'B' is that of C'C: one vertex, whose parents bear these two names.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planet/bisection/bisection.h"
#include "planet/bisection/huge_pages.h"
#include "planet/mesh/morph.h"

namespace planet {

/// One vertex of the refinement: the sides that it splits. A side is 3 name + k, from corner k of the named triangle.
struct SplitRecord {
    static constexpr std::uint32_t no_side = 0xffffffffu;
    enum Flag : std::uint8_t {
        first_becomes_four = 1,   ///< the first parent becomes four once both halves are split
        second_becomes_four = 2,  ///< so does the second
        over_flip = 4,            ///< the sides are those of quarters at C'C, which A'B' has replaced
    };

    std::uint32_t first;             ///< side of the first parent
    std::uint32_t second = no_side;  ///< of the second; no_side at the border
    std::uint8_t flags = 0;
};

class Progressive {
  public:
    using Index = std::uint32_t;
    static constexpr Index none = 0xffffffffu;
    static constexpr std::size_t max_note = 65535;

    /// Nothing but a base mesh: indices in range, attributes of every vertex.
    Progressive(PlainMesh base, BisectionRule rule, SideGeometry sides);
    /// The vertex that a record makes. @param place or, if not given, the midpoint
    /// @return false, and nothing changes, for a record that does not fit those before it
    bool append(const SplitRecord& record, const glm::dvec3* place = nullptr);
    /// The vertices that records make, quicker than one by one. @param place gives each its place by the
    /// midpoint of the ends of its side. @return false for a record that does not fit; those before it have been appended
    template <class Place>
    bool append(std::span<const SplitRecord> records, Place&& place);
    void reserve(std::size_t splits);

    const PlainMesh& base() const { return base_; }
    BisectionRule rule() const { return rule_; }
    SideGeometry sides() const { return sides_; }
    /// Free text that goes with the file: what its coordinates and attributes mean.
    const std::string& note() const { return note_; }
    /// Throws Error(bad_usage) if it is longer than max_note bytes.
    void set_note(std::string note);

    Index base_vertex_count() const { return base_vertices_; }
    Index vertex_count() const { return static_cast<Index>(places_.size()); }
    Index split_count() const { return static_cast<Index>(splits_.size()); }
    /// All triangles that any selection can have.
    Index name_count() const { return roots() + 4 * split_count(); }

    std::span<const glm::dvec3> places() const { return places_; }
    glm::dvec3 place(Index vertex) const { return places_[vertex]; }
    /// attribute_width numbers of each of the first vertices, interpolated.
    std::vector<float> attributes(Index vertex_count) const;
    /// Ends of the side that a vertex splits, both with lesser numbers; a base vertex has its own number for both.
    SplitSide ends(Index vertex) const;
    glm::dvec3 midpoint(Index a, Index b) const { return (places_[a] + places_[b]) * 0.5; }
    /// Vertices that must be there before it; none for what needs none.
    std::array<Index, 2> dependencies(Index vertex) const;
    /// Vertices that need it, or none; a vertex may be there twice.
    std::array<Index, 4> dependents(Index vertex) const;
    SplitRecord record(Index split) const {
        return {splits_[split].first, splits_[split].second, splits_[split].flags};
    }

    /// The mesh of the base and the first records. @param splits 0 .. split_count()
    PlainMesh prefix(Index splits) const;

    // ---- the triangles that there can be ----

    struct Child {
        Index name;
        std::array<Index, 3> corners;
    };
    /// The vertex that splits a triangle, or none.
    Index splitter(Index name) const {
        return name < roots() ? base_splitter_[name] : splits_[(name - roots()) / 4].splitter[(name - roots()) % 4];
    }
    /// The halves of a triangle that has a splitter.
    std::array<Child, 2> halves(Index name) const;
    /// Whether a triangle that has a splitter becomes four once both halves are split.
    bool becomes_four(Index name) const;
    /// The four, if it does and both halves have splitters: those at A, at B, at C, and the middle one.
    std::array<Child, 4> four(Index name) const;
    std::array<Index, 3> base_corners(Index name) const { return base_.triangles[name]; }

  private:
    // What a child is: its quarters, and which of its sides can be split, follow. Two bits in Split::kinds.
    enum Kind : std::uint8_t {
        complete,
        half_of_four,  ///< split opposite to C' only; its child at C is a quarter
        quarter,       ///< at C'C, which is all of it that can be split
        absent,        ///< there is no second parent
    };
    // A vertex of the refinement with all that later records ask of it, in one line of the cache.
    struct alignas(64) Split {
        std::array<Index, 5> corner;    ///< a, b of the side, c and d across it, the vertex itself
        std::array<Index, 4> splitter;  ///< of its children, or none
        Index first, second;            ///< its parents' sides (SplitRecord)
        std::uint8_t flags;             ///< of its SplitRecord
        std::uint8_t kinds;             ///< of its children, the first one's lowest
    };
    // A side of a triangle, from a to b, the corner across it, and what the triangle is.
    struct Parent {
        Index a, b, c;
        Kind kind;
        unsigned odd;     ///< whether it is the second child of its own parent
        Index* splitter;  ///< nullptr for a side that no triangle has, or that cannot be split
    };

    Index roots() const { return static_cast<Index>(base_.triangles.size()); }
    const Split& split_of(Index vertex) const { return splits_[vertex - base_vertices_]; }
    Parent parent(Index side);
    bool link(const SplitRecord& record);
    std::size_t link(std::span<const SplitRecord> records);
    std::array<Index, 3> corners_of_child(Index vertex, Index child) const;
    static constexpr unsigned record_bits = 7;

    PlainMesh base_;
    Index base_vertices_;
    BisectionRule rule_;
    SideGeometry sides_;
    std::string note_;
    LargeArray<glm::dvec3> places_;     ///< by vertex
    LargeArray<Split> splits_;          ///< by vertex of the refinement
    std::vector<Index> base_splitter_;  ///< by base triangle
};

template <class Place>
bool Progressive::append(std::span<const SplitRecord> records, Place&& place) {
    constexpr std::size_t ahead = 16;  // vertices, in which time memory answers
    const std::size_t linked = link(records), end = splits_.size();
    for (std::size_t i = end - linked; i < end; ++i) {
        const auto& next = splits_[std::min(i + ahead, end - 1)].corner;
        for (const Index v : {next[0], next[1]}) {
            __builtin_prefetch(&places_[v].x);
            __builtin_prefetch(&places_[v].z);
        }
        places_.push_back(place(midpoint(splits_[i].corner[0], splits_[i].corner[1])));
    }
    return linked == records.size();
}

/// A conforming mesh between the base and the whole: a set of vertices closed under dependencies.
class Selection {
  public:
    using Index = Progressive::Index;

    /// The base mesh. @param mesh outlives it
    explicit Selection(const Progressive& mesh);

    bool contains(Index vertex) const { return vertex != Progressive::none && in_[vertex] != 0; }
    std::size_t vertex_count() const { return count_; }
    /// Puts in a vertex and all it depends on. @return how many were put in
    std::size_t insert(Index vertex);
    /// Takes out a vertex of the refinement and all that depend on it. @return how many were taken out
    std::size_t remove(Index vertex);
    /// The first `splits` records, and no others.
    void set_prefix(Index splits);
    /// The least selection with all vertices that are wanted. Asks of each once, in their order.
    void select(const std::function<bool(Index vertex)>& wanted);

    /// Leaves, those below one triangle one after the other; corners are vertices of the whole.
    std::vector<std::array<Index, 3>> triangles() const;
    /// With the vertices that are in only, in their order.
    /// @param fraction if given, of every vertex of the refinement: where it is on its way from the midpoint of its
    ///                 side's ends, as they are, to its place, 0..1 (morph.h)
    PlainMesh mesh(const std::function<double(Index vertex)>& fraction = {}) const;

    const Progressive& whole() const { return *mesh_; }
    /// The children of a triangle in this mesh: none, two or four.
    struct Children {
        std::array<Progressive::Child, 4> child;
        int count = 0;
    };
    Children children(Index name) const;

  private:
    const Progressive* mesh_;
    std::vector<std::uint8_t> in_;  ///< by vertex
    std::size_t count_;
    std::vector<Index> stack_;
};

/// Finds the triangle of a selection that holds a point: the base triangle by a tree of boxes, then from a triangle to the child
/// beyond a line or two, of which children divide their parent exactly.
class PointLocator {
  public:
    using Index = Progressive::Index;

    /// @param mesh outlives it
    explicit PointLocator(const Progressive& mesh);

    struct Found {
        Index name;
        std::array<Index, 3> corners;
        int depth = 0;        ///< triangles gone through below the base triangle
        int comparisons = 0;  ///< of the point with boxes and lines
    };
    /// In plan, where triangles are thought not to overlap; std::nullopt if no base triangle holds the point.
    std::optional<Found> locate(const Selection& selection, glm::dvec2 point) const;

  private:
    struct Box {
        glm::dvec2 low, high;
    };
    void build(std::size_t node, std::size_t begin, std::size_t end);
    bool base_holds(Index t, glm::dvec2 point) const;
    std::optional<Index> base_triangle(glm::dvec2 point, int& comparisons) const;

    const Progressive& mesh_;
    std::vector<Index> order_;  ///< base triangles, those of a node next to each other
    std::vector<Box> boxes_;    ///< a heap: children of node i are 2 i + 1 and 2 i + 2
};

}  // namespace planet
