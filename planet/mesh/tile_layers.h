#pragma once
// Where tiles begin: the faces' at bisection level 0, those below them at `first`, those below these 12 levels further
// down, and so on.
//
//     first     layers of roots               A tile with tiles below it is as deep as the next layer says: a face's
//     12        0, 12, 24, 36, 48             `first` levels, any other 12. So `first` decides how deep the last tiles
//     1         0, 1, 13, 25, 37, 49          of a store are: those of cells down to level 37 have 12 levels with first
//     9         0, 9, 21, 33, 45, 57          1, but a single one, four vertices, with first 12.

#include <cstddef>

#include "planet/mesh/tile_layout.h"
#include "planet/octahedron/location_code.h"

namespace planet {

/// The layers of a store: the same for all its tiles.
struct TileLayers {
    int first = tile_levels;  ///< 1..12

    /// The root's level of the tile that holds the records of cells of a bisection level.
    constexpr int root_level(int level) const { return level < first ? 0 : level - (level - first) % tile_levels; }
    constexpr bool begin_at(int level) const { return root_level(level) == level; }
    /// The layer of the tile that holds those records: 0 for the faces, 1 for the tiles below them.
    constexpr std::size_t layer(int level) const {
        return static_cast<std::size_t>((level - first + tile_levels) / tile_levels);
    }
    /// How deep a tile is that has tiles below it, and how deep any is at most.
    constexpr int depth(int root_level) const { return root_level == 0 ? first : tile_levels; }

    /// The tile above one that is no face.
    constexpr LocationCode above(LocationCode root) const { return LocationCode(root.bits() >> depth_above(root)); }
    /// The local index, in the tile above, of the cell at which this tile begins.
    constexpr unsigned local_above(LocationCode root) const {
        const unsigned end = 1u << depth_above(root);
        return end | (static_cast<unsigned>(root.bits()) & (end - 1));
    }
    /// Its place among the cells at the end of the tile above, from 0.
    constexpr unsigned position(LocationCode root) const {
        return static_cast<unsigned>(root.bits()) & ((1u << depth_above(root)) - 1);
    }
    /// The root of the tile below at a position.
    constexpr LocationCode below(LocationCode root, std::uint64_t position) const {
        return LocationCode(root.bits() << depth(root.bisection_level()) | position);
    }

    friend constexpr bool operator==(TileLayers, TileLayers) = default;

  private:
    constexpr int depth_above(LocationCode root) const { return root.bisection_level() == first ? first : tile_levels; }
};

}  // namespace planet
