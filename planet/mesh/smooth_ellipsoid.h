#pragma once
// A smooth ellipsoid as a closed conforming mesh, without tiles and without data: bodies that have none, meshes of one
// level, benchmarks. The same split test, order and vertices as refine.h, from one table of bounds a level.

#include <span>
#include <vector>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/grid.h"
#include "planet/mesh/growing_array.h"
#include "planet/mesh/strip.h"
#include "planet/octahedron/location_code.h"

namespace planet {

/// What the split test reads of a diamond (tile.h), the same for all of a bisection level, metres. *Saturated*: a
/// level's deviation is at least that of the next, and its radius at least the next one's and the distance between
/// their split vertices.
struct LevelBounds {
    double deviation = 0;  ///< 0: never split
    double radius = 0;
};

/// Saturated bounds of an ellipsoid, by bisection level: cells of level 0 .. finest_level - 1 can be split.
/// The deviation is certified: the largest distance along the geodetic normal between the plane of a cell and the
/// ellipsoid (for f up to 1/50; beyond, a is so far from b that the planes of whole faces are no measure).
/// @param finest_level 0 .. max_bisection_level
/// @param roughness added to the deviation for each metre of a cell's longest side: spreads leaves over the levels
///        as terrain does
std::vector<LevelBounds> smooth_bounds(const Ellipsoid& ellipsoid, int finest_level, double roughness = 0);

/// The mesh as one strip over unique vertices. Keeps its storage from one use to the next. An ellipsoid must lie within
/// the vertex grid: a <= grid_limit_m.
class SmoothEllipsoid {
  public:
    explicit SmoothEllipsoid(const Ellipsoid& ellipsoid) : ellipsoid_(ellipsoid) {}

    /// Replaces the mesh by the leaves of SplitTest{eye, K} (view.h) over the bounds, in Sierpinski order. Without
    /// branches on data that is far from any limit: some four in five leaves come in blocks of equal level, whose
    /// split vertices and strip are made at once.
    /// @param eye ecef, metres @param K metres of distance per metre of deviation
    void refine(std::span<const LevelBounds> bounds, const glm::dvec3& eye, double K);

    /// Replaces the mesh by all cells of one level: 8 * 2^level triangles. @param bisection_level 0..26
    void refine_to_level(int bisection_level);

    /// Counter-clockwise seen from outside; a triangle of the strip with two equal vertices is only a turn of it.
    std::span<const GridPosition> vertices() const { return vertices_.span(); }
    std::span<const std::uint32_t> strip() const { return strip_.indices().span(); }
    /// V - E + F = 2.
    std::size_t triangles() const { return 2 * vertices_.size() - 4; }

  private:
    Ellipsoid ellipsoid_;
    GrowingArray<GridPosition> vertices_;
    StripWriter strip_;
};

}  // namespace planet
