#pragma once
// Longest-side bisection of any triangle mesh: Stamm, Eidenbenz and Pajarola, "A Modified Longest Side Bisection
// Triangulation", after Rivara and after Rosenberg and Stenger.
//
//            C                      C                       C             plain: a triangle is split from the middle C'
//           /|\                    /|\                     / \            of its longest side AB to the corner C.
//          / | \                B'/ | \                 B'/___\A'
//         /  |  \                / \|  \                 / \ / \          modified: so it is, but where
//        A---C'--B              A---C'--B               A---C'--B
//       two halves          one half is split      both halves are split  (2)  |BC| >= |CC'| >= |BC'|
//
// holds (AB the longest side, BC the shortest) and both halves are split, C'C gives way to A'B' (definition 4.1): four
// triangles similar to ABC. The halves of such a triangle, and the quarters C'CB' and C'CA' between, are *pending*: no
// other leaf has an angle below arctan(sqrt(7)/5) / arccos(3/4) = 0.673408 of the smallest one of its base triangle;
// pending leaves keep 1/2, and so do all under the plain rule.
//
// "Longest" is a total order, the same from both triangles of a side: length, then age; of the sides of the base mesh,
// the one with the lower vertex numbers (the lesser end, then the greater) is longer. Lengths are judged on the flat base triangles, where
// every vertex is a midpoint: halves of a side have exactly half its length, and where a Placement puts a vertex
// plays no part.
//
// A split of a side that is not the longest of its two triangles is preceded by splits of longer sides only (lemma 4.2).
// After every single split the mesh is conforming.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "planet/bisection/plain_mesh.h"

namespace planet {

enum class BisectionRule : std::uint8_t { modified, plain };
/// Where sides are judged: x and y only, or all three coordinates.
enum class SideGeometry : std::uint8_t { space, plan };

/// Where a new vertex belongs, by the placed ends of the side that it splits, in either order: on the terrain, on a sphere.
/// In plan, x and y must be those of the midpoint.
using Placement = std::function<glm::dvec3(const glm::dvec3& a, const glm::dvec3& b)>;

/// Corners of a triangle as placed, in the orientation of the base mesh.
using TrianglePlaces = std::array<glm::dvec3, 3>;

/// Sets the deviation of each triangle, >= 0: what its split is to make less. NaN counts as 0. First called for the whole
/// mesh, then for the few triangles that each split leaves.
using DeviationMeasure = std::function<void(std::span<const TrianglePlaces> triangles, std::span<double> deviations)>;

struct BisectionOptions {
    BisectionRule rule = BisectionRule::modified;
    SideGeometry sides = SideGeometry::space;
    Placement place = {};  ///< empty: at the midpoint
};

enum class SplitOrder { length, deviation };

/// What to refine for. At least one limit is given; splits stop when the first two are both met in all of the region,
/// or when the next one would exceed a maximum.
struct RefineGoal {
    static constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

    double max_side = std::numeric_limits<double>::infinity();  ///< > 0; of judged sides and, in space, of placed ones
    double max_deviation = std::numeric_limits<double>::infinity();  ///< >= 0; needs `deviation`
    std::size_t max_triangles = no_limit;                            ///< never exceeded
    SplitOrder order = SplitOrder::length;                           ///< what is split first
    DeviationMeasure deviation = {};
    /// Only triangles for which this holds are split for their own sake; empty: all.
    std::function<bool(const TrianglePlaces&)> region = {};
};

enum class RefineEnd {
    met,     ///< all limits but that of triangles are met
    budget,  ///< the next split would exceed max_triangles
    finest,  ///< what is left to split has sides too short to halve
};

struct RefineResult {
    RefineEnd end = RefineEnd::met;
    std::size_t splits = 0;
    /// Largest of the triangles in the region, as last measured. 0 without a measure.
    double deviation_max = 0;
};

struct BisectionReport {
    std::size_t triangles = 0, vertices = 0, base_triangles = 0, base_vertices = 0;
    std::size_t splits = 0;       ///< vertices inserted
    std::size_t requests = 0;     ///< splits that were asked for; the others came before them
    double propagation_mean = 0;  ///< splits that came before one that was asked for
    std::size_t propagation_max = 0;
    std::size_t pending_triangles = 0;
    // Radians, in the geometry in which sides are judged.
    double angle_min = 0;           ///< of all leaves
    double angle_min_complete = 0;  ///< of those not pending; of all if all are
    /// Smallest ratio of an angle of a leaf that is not pending to the smallest one of its base triangle, and of one that is; 1 if there is
    /// none.
    double angle_ratio_min = 1, angle_ratio_min_pending = 1;
    /// Different shapes (ratios of sides to 6 digits) that leaves have: in all, and at most below one base triangle.
    std::size_t similarity_classes = 0, similarity_classes_max = 0;
    double side_max = 0;  ///< longest judged side
    double side_max_placed = 0;
};

class Progressive;

class Bisection {
  public:
    using Index = std::uint32_t;
    static constexpr Index none = 0xffffffffu;

    /// A side of a leaf: from its corner k to its corner (k + 1) % 3. Side 0 is its longest.
    struct LeafSide {
        Index triangle;
        int side;
    };

    /// Throws Error(bad_data), naming the triangle or side by its vertices, for a mesh without triangles, with more than 2^28
    /// of them, with indices out of range, coordinates that are not finite or beyond 1e30, triangles without area or with
    /// two equal corners, sides of three triangles, triangles that turn unlike their neighbours, or two at the same corners.
    explicit Bisection(const PlainMesh& base, BisectionOptions options = {});
    Bisection(Bisection&&) noexcept;
    Bisection& operator=(Bisection&&) noexcept;
    ~Bisection();

    std::size_t triangle_count() const;  ///< leaves
    std::size_t vertex_count() const;
    std::size_t base_vertex_count() const;
    std::size_t base_triangle_count() const;
    /// Of a leaf, in the orientation of the base mesh: the first two are the ends of its longest side.
    std::array<Index, 3> corners(Index triangle) const;
    /// The leaf beyond a side, or none at the border.
    Index neighbor(Index triangle, int side) const;
    glm::dvec3 place(Index vertex) const;
    TrianglePlaces places(Index triangle) const;
    double side_length(Index triangle, int side) const;  ///< as judged, metres
    bool pending(Index triangle) const;
    Index base_triangle(Index triangle) const;

    // Each returns how many sides it split, 0 if they are too short to halve (shorter than 2^-40 of the largest coordinate).

    /// Splits the longest side of a leaf, what must be split first before it.
    std::size_t split(Index triangle);
    /// Splits any side. Of a quarter, C'C may give way to A'B' instead.
    std::size_t split_side(LeafSide side);
    /// One uniform step: the middle of the longest side of every leaf (in the region, if given) becomes a vertex. After two steps
    /// both rules have the same vertices.
    std::size_t step(const std::function<bool(const TrianglePlaces&)>& region = {});
    /// Throws Error(bad_usage) for a goal without or with senseless limits.
    RefineResult refine(const RefineGoal& goal);

    /// The side nearest to a point in plan, of the leaf that holds it, in which the mesh is thought to have no overhangs;
    /// std::nullopt if none does.
    std::optional<LeafSide> nearest_side(glm::dvec2 point) const;

    std::size_t bytes() const;  ///< of memory held, the queue of the last refinement included
    BisectionReport report() const;
    /// Empty if all links fit, both triangles of every side know one length, longest sides are longest, every leaf turns as
    /// its base triangle does, and areas add up; else the first thing that is wrong.
    std::string check() const;

    PlainMesh mesh() const;
    /// The same as split records: the base mesh and its refinement in the order in which it was made.
    Progressive progressive() const;

    struct State;  // bisection_state.h

  private:
    std::unique_ptr<State> state_;
};

}  // namespace planet
