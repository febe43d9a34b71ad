#pragma once
// What resampling lost in one tile: the largest distance of a source sample from the finest surface.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/mesh/deviation.h"
#include "planet/mesh/tile.h"
#include "planet/store/tile_sides.h"

namespace planet {

/// One thread's: keeps its memory.
class TileResampling {
  public:
    /// The tile for which samples are asked. @param lattice with normals and positions @param exists by local index
    struct Surface {
        const ElevationField& field;
        const Placement& placement;
        const Tile& tile;
        const TileLattice& lattice;
        std::span<const std::uint8_t> exists;
    };

    /// The largest |height of a sample - surface| in metres, rounded up to float, over the field's samples in those of
    /// the tile's own cells that have no cells below. A sample on a side counts for the cells on both sides. Samples are
    /// asked for in caps of at most some ten thousands.
    /// @param has_tile_below by position at relative level 12, 1 where the cells below are another tile's; or empty
    float largest(const Surface& surface, std::span<const std::uint8_t> has_tile_below);

  private:
    void certify_without_tiles(unsigned local, std::span<const std::uint8_t> has_tile_below);
    void certify(LocationCode cell, unsigned local);
    void certify_samples(LocationCode cell, unsigned local);
    unsigned finest_cell(unsigned from, const glm::dvec3& n) const;
    double height(unsigned local, const glm::dvec3& n);

    const Surface* surface_ = nullptr;
    std::vector<glm::dvec3> normals_;
    std::vector<float> heights_;
    unsigned at_ = 0;  // the cell of the plane
    glm::dvec3 corner_{0}, plane_{0};
    double largest_ = 0;
};

}  // namespace planet
