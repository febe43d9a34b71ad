#pragma once
// What resampling lost in one tile: the largest distance of a source sample from the finest surface.

#include <cstdint>
#include <span>

#include "planet/bake/sample_distance.h"
#include "planet/elevation/elevation_field.h"

namespace planet {

/// One thread's: keeps its memory.
class TileResampling {
  public:
    /// Of a tile: its heights and undulations, its lattice with normals and positions, and by local index which diamonds
    /// exist.
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
    /// @param has_tile_below by position at relative level `depth`, 1 where the cells below are another tile's; or empty
    float largest(const Surface& surface, std::span<const std::uint8_t> has_tile_below);

  private:
    void add_without_tiles(const Surface& surface, LocationCode cell, std::span<const std::uint8_t> has_tile_below);
    void add(const Surface& surface, LocationCode cell);

    SampleDistance distance_;
};

}  // namespace planet
