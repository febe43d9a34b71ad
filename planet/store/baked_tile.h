#pragma once
// A tile as the bake encodes it.

#include <cstdint>
#include <vector>

#include "planet/mesh/tile.h"
#include "planet/store/tile_sides.h"

namespace planet {

/// How many steps of the ladder the settled record of a side cell lies above what its own tile knows of it: what a leaf
/// tile has to store.
struct SideGain {
    std::uint16_t deviation = 0;
    std::uint16_t radius = 0;
};

struct BakedTile {
    Tile tile;                         ///< deviation and radius: of inner tiles only
    std::vector<std::uint8_t> exists;  ///< by local index
    std::vector<SideGain> gain;        ///< by side cell; of leaf tiles only
    bool has_tiles_below = false;
    bool inner() const { return has_tiles_below; }
};

}  // namespace planet
