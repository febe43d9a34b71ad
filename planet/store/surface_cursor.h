#pragma once
// The surface of a store at a direction: descent to the finest cell there, and the plane of that cell.
//
// A cursor remembers the path from the face down to where it was last. A direction near the last one starts from the
// nearest cell of that path that holds it, so that coherent queries cost a few levels each.

#include <array>
#include <memory>
#include <vector>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/tile.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/tile_reader.h"

namespace planet {

/// The files that a height on the surface is from, by number (HeightOrigin): of the vertex with the greatest weight
/// first, then those of the other vertices in the order of their weights.
struct SurfaceOrigin {
    std::array<std::uint32_t, 6> files{};
    std::uint32_t count = 0;  ///< 0: it is not known

    friend bool operator==(const SurfaceOrigin&, const SurfaceOrigin&) = default;
};

/// One thread's. The reader must outlive it.
class SurfaceCursor {
  public:
    SurfaceCursor(const TileReader& tiles, const Placement& placement);

    /// Moves to the cell that holds a unit geodetic normal: the finest one that exists, but none of a bisection level
    /// beyond `finest_level`. On a side, one of the cells that meet there.
    void seek(const glm::dvec3& normal, int finest_level = max_bisection_level);

    /// Where it is.
    LocationCode cell() const;
    /// The tile that holds the cell: for the last cells of a tile with children, the child tile where there is one.
    const Tile& tile() const { return *path_.back().tile; }
    /// The certified deviation of the cell from the finest surface, metres: 0 if it is of the finest surface.
    float deviation() const;

    /// Height above the datum, metres, of the plane of the cell along a normal (unit) in it: where the normal's line
    /// meets the plane, less the undulation there, linear between the corners.
    double height(const glm::dvec3& normal);

    /// The same, linear between the corners' heights: without the sag of the plane, which is a chord of the curved planet
    /// and passes below a level sea by up to side^2 / 8 R, 1.6 m in cells of 9 km. Continuous; equal to height() at corners.
    double interpolated_height(const glm::dvec3& normal) const;
    /// Where height() and interpolated_height() come from.
    SurfaceOrigin origin(const glm::dvec3& normal) const;
    /// Of the datum above the ellipsoid, metres, linear between the corners; 0 if the store knows none.
    double undulation(const glm::dvec3& normal) const;

  private:
    struct Step {
        Corners corners;
        const Tile* tile;
        unsigned local;
        bool counter_clockwise;
        bool has_split;     // the next two are known
        glm::dvec3 split;   // the cell's split vertex
        glm::dvec3 middle;  // normal of the plane through the planet's centre, the split vertex and the apex
    };

    bool holds(const Step& step, const glm::dvec3& n) const;
    void start(const glm::dvec3& n);
    bool enter_tile_below(Step& step);
    void set_plane();
    glm::dvec3 weights(const glm::dvec3& n) const;

    const TileReader* tiles_;
    Placement placement_;
    std::vector<Step> path_;                                                               // by bisection level
    std::array<std::shared_ptr<const Tile>, max_bisection_level / tile_levels + 1> held_;  // by layer of tiles

    bool plane_valid_ = false;
    glm::dvec3 corner_{0}, plane_{0};
    glm::dvec3 undulation_{0};  // at left, right, apex
    bool has_undulation_ = false;
};

}  // namespace planet
