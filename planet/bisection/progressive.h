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

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planet/bisection/bisection.h"
#include "planet/mesh/morph.h"

namespace planet {

class Progressive {
  public:
    using Index = std::uint32_t;
    static constexpr Index none = 0xffffffffu;

    const PlainMesh& base() const { return base_; }
    BisectionRule rule() const { return rule_; }
    SideGeometry sides() const { return sides_; }
    /// Free text that goes with the file, at most 65,535 bytes: what its coordinates and attributes mean.
    const std::string& note() const { return note_; }
    void set_note(std::string note);

    Index base_vertex_count() const { return static_cast<Index>(base_.vertices.size()); }
    Index vertex_count() const { return static_cast<Index>(places_.size()); }
    Index split_count() const { return vertex_count() - base_vertex_count(); }
    /// All triangles that any selection can have.
    Index name_count() const { return static_cast<Index>(base_.triangles.size()) + 4 * split_count(); }

    std::span<const glm::dvec3> places() const { return places_; }
    /// attribute_width numbers a vertex, interpolated.
    std::vector<float> attributes(Index vertex_count) const;
    /// Ends of the side that a vertex splits, both with lesser numbers; a base vertex has its own number for both.
    SplitSide ends(Index vertex) const;
    /// Vertices that must be there before it; none for what needs none.
    std::array<Index, 2> dependencies(Index vertex) const;
    /// Vertices that need it, at most four; none for the rest. A vertex may be there twice.
    std::array<Index, 4> dependents(Index vertex) const;

    /// The mesh of the base and the first records. @param splits 0 .. split_count()
    PlainMesh prefix(Index splits) const;

  private:
    PlainMesh base_;
    BisectionRule rule_ = BisectionRule::modified;
    SideGeometry sides_ = SideGeometry::space;
    std::string note_;
    std::vector<glm::dvec3> places_;
};

/// A conforming mesh between the base and the whole: a set of vertices closed under dependencies.
class Selection {
  public:
    using Index = Progressive::Index;

    /// The base mesh. @param mesh outlives it
    explicit Selection(const Progressive& mesh);

    bool contains(Index vertex) const;
    std::size_t vertex_count() const;
    /// Puts in a vertex and all it depends on. @return how many were put in
    std::size_t insert(Index vertex);
    /// Takes out a vertex of the refinement and all that depend on it. @return how many were taken out
    std::size_t remove(Index vertex);
    /// The first `splits` records, and no others.
    void set_prefix(Index splits);
    /// The least selection with all vertices that are wanted. Asks of each once.
    void select(const std::function<bool(Index vertex)>& wanted);

    /// Leaves, children of a triangle one after the other; corners are vertices of the whole.
    std::vector<std::array<Index, 3>> triangles() const;
    /// With the vertices that are used only, in their order.
    /// @param fraction if given, of every vertex of the refinement: where it is on its way from the midpoint of its side's ends, as they
    ///                 are, to its place, 0..1 (morph.h)
    PlainMesh mesh(const std::function<double(Index vertex)>& fraction = {}) const;

    struct Found {
        std::array<Index, 3> corners;  ///< of the leaf that holds the point
        int depth = 0;                 ///< triangles gone through, from a base triangle down
        int comparisons = 0;           ///< of the point with a line
    };
    /// The leaf that holds a point in plan; std::nullopt if none does. O(depth), after a look-up in a grid of base triangles.
    std::optional<Found> locate(glm::dvec2 point) const;

  private:
    const Progressive* mesh_;
};

// ---- files: .oprog ----

struct ProgressiveFormat {
    /// 0: places as they are, in doubles. Else new vertices are rounded to multiples of this, metres, from the midpoint
    /// of the side that they split, which takes one to three bytes a coordinate; a power of two.
    double quantum = 0;
};

/// The bytes of a file.
std::vector<std::uint8_t> encode_progressive(const Progressive& mesh, const ProgressiveFormat& format = {});

/// @param where    names the file in errors
/// @param fraction of the records to read, 0..1, rounded to the nearest count; what comes after is not looked at
/// Throws Error(bad_data) for bytes that are no such file, cut short, damaged, or say what cannot be. Memory stays within
/// 200 times their number.
Progressive decode_progressive(std::span<const std::uint8_t> bytes, const std::string& where, double fraction = 1);

/// Reads a file. Throws Error(bad_data), also for a file that is not there.
Progressive read_progressive(const std::string& path, double fraction = 1);

}  // namespace planet
