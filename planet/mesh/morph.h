#pragma once
// Morph: a vertex on its way between the midpoint of the side that it splits and its place, so that meshes change without
// a pop.
//
//     blended = (1 - f) midpoint(blended ends) + f place
//
//        .-----.       f = 1: where it belongs
//        |\  .'|       f = 0: on the side, so that the mesh is the surface without it. With f = 0 for all vertices that a
//        | \*  |              coarser mesh lacks, however many levels finer, all lie on that mesh's triangles.
//        |.'\  |
//        .-----.       Ends that morph take their vertices along.
//
// f may depend on nothing but the diamond (and what is the same for all). Then all cells at a vertex compute the same
// bits, from either end, and nothing cracks. Nothing pops if f is 0 where a vertex comes and goes, and f of a vertex is at
// most that of those it depends on, as with fractions of saturated numbers: with a vertex goes its merging domain.
//
// A vertex shader does not know where the ends are by now. It takes the middle of their *places*, which is right once both
// have arrived:
//
//     drawn = (1 - f) midpoint(places of ends) + f place
//
// **Nothing pops then if every vertex has arrived before one comes on a side that ends in it.** A vertex e comes at the
// distance reach(e) = radius + K deviation. Before v comes, on a side with the end e, a diamond c between them has split,
// and saturated numbers leave room for e to arrive:
//
//         A
//        /|          reach(e) - reach(v) >= |e - c| + |c - v|        radii hold what is below, deviations do not grow
//       c |          so where v comes, e has been nearer than reach(e) for |e - c| + |c - v| - |e - v| at least:
//      /  |          ((a + b)^2 - g^2) / (2 radius), with a, b, g the three lengths on the ground, however high they are;
//     L-v-e         (a + b)^2 - g^2 >= split side^2 / 8, the level's shortest (measured for all cells).
//
// So the mesh is drawn as a continuous function of the eye and of K: as the eye goes a step h, and K changes by k, no point
// of the surface moves by more than the largest 1.5 |place - midpoint| / width (h + k deviation), whatever is split and
// merged on the way. This holds for one K for test and morph. Sides below 30 m or so are an exception, as the split test
// rounds a vertex to half a metre: these may jump by as much of their way. Tiles that are loaded bring their vertices at
// once, and a step of a budget (BudgetSteps) is a change of K like any other.

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "planet/octahedron/cell_metrics.h"
#include "planet/quadtree/triangulation.h"

namespace planet {

/// f by s, a diamond's number over its threshold (saturated deviation over tolerance): 0 up to s = 1, where the vertex
/// goes, 1 from s = whole on, between them 3 t^2 - 2 t^3: continuous, with its derivative. NaN (0 over 0) gives 0.
/// @param whole > 1
inline double morph_fraction(double s, double whole = 2) {
    assert(whole > 1);
    if (!(s > 1)) return 0;
    const double t = (std::min(s, whole) - 1) / (whole - 1);
    return t * t * (3 - 2 * t);
}

/// How much nearer than its reach an eye is, at most, when a vertex has arrived, see above: metres, > 0. What the split test
/// rounds is taken off. @param bisection_level, radius_m of its diamond, exaggerated as in the split test
inline constexpr double arrival_rounding_m = 0.5;
inline double arrival_width(int bisection_level, double radius_m, double planet_radius_m) {
    const double side = cell_metrics(bisection_level).split_min * planet_radius_m;
    const double width = side * side / (18 * radius_m);  // an eighth, and a ninth of it to be safe
    return std::max(width - 2 * arrival_rounding_m, 0.5 * width);
}

/// f of a vertex that a split test brings at a distance `reach`: 3 t^2 - 2 t^3, t = 0 from there on, 1 nearer by `width`.
inline double arrival_fraction(double distance, double reach, double width) {
    const double t = std::clamp((reach - arrival_rounding_m - distance) / width, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// Exactly the midpoint for f = 0, exactly the place for f = 1, monotone between; the same bits whichever end comes first.
/// Heights, or positions in a frame in which sides are straight. @param f 0..1
inline double morphed(double end_a, double end_b, double place, double f) {
    return std::lerp((end_a + end_b) / 2, place, f);
}
inline glm::dvec3 morphed(const glm::dvec3& end_a, const glm::dvec3& end_b, const glm::dvec3& place, double f) {
    return {morphed(end_a.x, end_b.x, place.x, f), morphed(end_a.y, end_b.y, place.y, f),
            morphed(end_a.z, end_b.z, place.z, f)};
}

/// The ends of the side that a vertex splits, by number: both less than its own. A vertex that splits none, such as a
/// corner of a root, has its own number for both.
struct SplitSide {
    std::uint32_t a, b;
};

/// Morphs all vertices of a mesh, in place. @param places of all vertices; glm::dvec3 or double
/// @param sides as many @param fraction f by number of a vertex that splits a side
template <class Place, class Fraction>
void morph(std::span<Place> places, std::span<const SplitSide> sides, Fraction&& fraction) {
    assert(places.size() == sides.size());
    for (std::uint32_t v = 0; v < places.size(); ++v) {
        const auto [a, b] = sides[v];
        assert(a <= v && b <= v);
        if (a != v) places[v] = morphed(places[a], places[b], places[v], fraction(v));
    }
}

/// Corners of roots by number, left, right, apex, and how many there are.
inline std::array<std::uint32_t, 3> root_corner_numbers(const PatchGrid& grid, CellCode root) {
    const auto number = static_cast<int>(root - grid.root(0));
    const int columns = grid.columns(), patch = number / 2;
    const auto south_west = static_cast<std::uint32_t>(patch / columns * (columns + 1) + patch % columns);
    const std::uint32_t north_west = south_west + static_cast<std::uint32_t>(columns) + 1;
    if (number % 2 == 0) return {south_west, north_west + 1, north_west};
    return {north_west + 1, south_west, south_west + 1};
}
inline std::uint32_t root_corner_count(const PatchGrid& grid) {
    return static_cast<std::uint32_t>((grid.columns() + 1) * (grid.rows() + 1));
}
/// E_0 .. E_3, the north pole, the south pole.
inline std::array<std::uint32_t, 3> root_corner_numbers(const OctahedronTopology&, CellCode root) {
    const auto face = static_cast<std::uint32_t>(root & 7), i = face & 3, next = (i + 1) & 3;
    if (face < 4) return {i, next, 4};
    return {next, i, 5};
}
inline std::uint32_t root_corner_count(const OctahedronTopology&) {
    return 6;
}

/// The vertices of a triangulation such that the ends of a side come before the vertex that splits it: a mesh that can
/// morph. First the corners of the roots, as numbered above, used or not.
struct MorphOrder {
    std::vector<SplitSide> sides;    ///< by vertex
    std::vector<CellCode> diamonds;  ///< by vertex; 0 for a corner of a root
    std::vector<std::array<std::uint32_t, 3>>
        triangles;  ///< counter-clockwise, the apex last; all leaves in the order of the curve
};

template <Topology Topo, class SplitSet>
class MorphOrderWalk {
  public:
    explicit MorphOrderWalk(const Triangulation<Topo, SplitSet>& mesh) : mesh_(mesh) {}

    MorphOrder run() {
        const Topo& topology = mesh_.topology();
        for (std::uint32_t v = 0; v < root_corner_count(topology); ++v) add_vertex(0, {v, v});
        for (int rank = 0; rank < topology.root_count(); ++rank)
            cell(topology.root(rank), 0, root_corner_numbers(topology, topology.root(rank)));
        return std::move(order_);
    }

  private:
    std::uint32_t add_vertex(CellCode diamond, SplitSide side) {
        order_.sides.push_back(side);
        order_.diamonds.push_back(diamond);
        return static_cast<std::uint32_t>(order_.sides.size() - 1);
    }
    void cell(CellCode code, int level, const std::array<std::uint32_t, 3>& corners) {
        const auto [left, right, apex] = corners;
        if (level == mesh_.levels() || !mesh_.is_split(code)) {
            order_.triangles.push_back(level % 2 == 0 ? corners : std::array{right, left, apex});
            return;
        }
        const CellCode name = diamond(mesh_.topology(), code);
        const auto [at, is_new] = vertex_.try_emplace(name, 0);
        if (is_new) at->second = add_vertex(name, {left, right});
        const std::uint32_t middle = at->second;
        cell(code << 1, level + 1, {left, apex, middle});
        cell(code << 1 | 1, level + 1, {apex, right, middle});
    }

    const Triangulation<Topo, SplitSet>& mesh_;
    std::unordered_map<CellCode, std::uint32_t> vertex_;  ///< by diamond
    MorphOrder order_;
};

template <Topology Topo, class SplitSet>
MorphOrder morph_order(const Triangulation<Topo, SplitSet>& mesh) {
    return MorphOrderWalk<Topo, SplitSet>(mesh).run();
}

}  // namespace planet
