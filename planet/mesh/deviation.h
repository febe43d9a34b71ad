#pragma once
// Deviation: how far, along the geodetic normal of a vertex, the plane of a coarser cell passes from it.
//
//         A---____                    t = (A - P) . N / (n . N)       P   the vertex at its true height, ecef
//        /   |    ----___   plane                                     n   its geodetic normal
//       /    | t         ----B                                        A   a corner of the cell at its true height
//      /     P  n                                                     N   the normal of the plane through the corners
//
// which is (A - p0) . N / (n . N) - h with p0 the foot of P on the ellipsoid. The plane is extended, so t is defined
// for vertices on the cell's sides, whose normals may pass it by; the curvature of the planet is in it. The deviation
// of a cell is the largest |t| over every vertex of the finest lattice in it, sides included.
//
// Everything here is elementwise arithmetic in double without contraction: the same bits for any vector width.

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/tile_layout.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

/// Added to every deviation before it is rounded up to float: bounds the rounding of t on planets up to 10,000 km, so
/// that what is stored is a bound, and what exists is never 0.
inline constexpr double deviation_rounding_m = 0x1p-26;

/// The lattice of a tile at its true heights. Arrays are by vertex index, padded with NaN to a multiple of 8. Made to
/// be used again and again: place() keeps the memory.
class TileLattice {
  public:
    /// Sets the normals of the vertices, `depth` levels below a cell with these corners. @param depth 1..12
    void set_normals(const Corners& root, int depth);
    /// Sets the positions. @param height above the datum, @param undulation of the datum above the ellipsoid or empty:
    /// by vertex index, metres. @param exists by local index, 1 where the cell's split vertex exists; empty: all do.
    /// A vertex that does not exist gets NaN coordinates, and no deviation heeds it.
    void set_positions(const Placement& placement, std::span<const float> height,
                       std::span<const GeoidUndulation> undulation, std::span<const std::uint8_t> exists);

    int depth() const { return depth_; }
    std::size_t size() const { return size_; }
    glm::dvec3 normal(std::size_t v) const { return {n_[0][v], n_[1][v], n_[2][v]}; }
    glm::dvec3 position(std::size_t v) const { return {p_[0][v], p_[1][v], p_[2][v]}; }
    /// Positions rounded to float: m of the split test, the same bits as in a PlacedTile at exaggeration 1.
    std::span<const glm::vec3> rounded() const { return rounded_; }
    /// One coordinate (0..2) of every normal or position, padded.
    const double* normals(int axis) const { return n_[axis].data(); }
    const double* positions(int axis) const { return p_[axis].data(); }

  private:
    int depth_ = 0;
    std::size_t size_ = 0;
    std::vector<double> n_[3], p_[3];
    std::vector<glm::vec3> rounded_;
};

/// The plane of a cell: a corner and the (unnormalized) normal.
struct CellPlane {
    CellPlane() = default;
    CellPlane(const glm::dvec3& left, const glm::dvec3& right, const glm::dvec3& apex)
        : corner(left), normal(glm::cross(right - left, apex - left)) {}
    glm::dvec3 corner{0}, normal{0};

    /// t of a point with geodetic normal n, metres, positive where the plane passes above.
    double above(const glm::dvec3& point, const glm::dvec3& n) const {
        return glm::dot(corner - point, normal) / glm::dot(n, normal);
    }
};

/// The least float above a positive one.
inline float next_up(float v) {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) + 1);
}

/// Rounds up to float, with deviation_rounding_m added. @param worst >= 0
inline float certified_deviation(double worst) {
    return next_up(static_cast<float>(worst + deviation_rounding_m));
}

/// The deviation of every cell of the tile over the tile's own vertices, by local index into 2^depth values, metres,
/// rounded up (certified_deviation). Cells that do not exist get what is meaningless.
void own_deviation(const TileLattice& lattice, std::span<float> deviation);

/// The largest |t| of any vertex of the tile but its root's corners (those belong to the parent's lattice).
double deviation_from(const TileLattice& lattice, const CellPlane& plane);

/// What bounds the |t| of every vertex of a tile from any plane without looking at the vertices: the triangle of its
/// root's corners, how far vertices lie from its plane, and how far they lie outside when seen along its normal.
class TileHull {
  public:
    /// The root's corners must exist.
    explicit TileHull(const TileLattice& lattice);

    /// At least deviation_from(lattice, plane); infinity for planes that are steep here.
    double deviation_bound(const CellPlane& plane) const;

    /// False only if deviation_from(lattice, plane), certified, is at most `known`: then there is no need to test.
    bool may_exceed(const CellPlane& plane, float known) const {
        return !(certified_deviation(deviation_bound(plane)) <= known);
    }

  private:
    glm::dvec3 corner_[3], normal_[3];  // of the root
    glm::dvec3 up_;                     // unit normal of the corners' plane
    double off_plane_ = 0;              // largest distance of a vertex from that plane, metres
    double outside_ = 0;                // the least barycentric coordinate of a vertex is -outside_
};

/// Largest distance from the rounded split vertex of cell i to the true corners of the cell, metres.
double corner_distance(const TileLattice& lattice, unsigned i);

/// Where radii of a tile start: corner_distance(), rounded up, of the existing cells that lack a child diamond; else 0.
/// @param exists, radius by local index @param inner whether the tile has tiles below it
/// @param lacks_below by position at the level below the last: whether the child diamonds in other tiles are incomplete
void corner_radii(const TileLattice& lattice, std::span<const std::uint8_t> exists, bool inner,
                  std::span<const std::uint8_t> lacks_below, std::span<float> radius);

/// own_deviation() and corner_radii() of a tile without tiles below it, faster than one after the other.
/// @param exists, deviation, radius by local index
void measure_leaf(const TileLattice& lattice, std::span<const std::uint8_t> exists, std::span<float> deviation,
                  std::span<float> radius);

/// The radius of a diamond given a child diamond, m and m_c their rounded split vertices. The slack keeps the split
/// test nested when it is evaluated in double: eyes within 50,000 km round by less than 2^-20 of any radius.
inline double radius_over(const glm::vec3& m, const glm::vec3& m_c, float child_radius) {
    const double dx = static_cast<double>(m.x) - static_cast<double>(m_c.x),
                 dy = static_cast<double>(m.y) - static_cast<double>(m_c.y),
                 dz = static_cast<double>(m.z) - static_cast<double>(m_c.z);
    return std::sqrt(dx * dx + dy * dy + dz * dz) + static_cast<double>(child_radius);
}
/// Rounds a radius up to float, slack of 2^-20 included. @param radius >= 0
inline float certified_radius(double radius) {
    return next_up(static_cast<float>(radius * (1 + 0x1p-20)));
}

}  // namespace planet
