#pragma once
// A tile as the bake encodes it, and the arithmetic of saturation that baking and reading share.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/deviation.h"
#include "planet/mesh/tile.h"
#include "planet/store/coverage.h"
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

/// The records of one tile as they are saturated. Spans are by local index, but `rounded` by vertex index.
struct Saturation {
    const TileLayout& layout;
    int depth;
    std::span<float> deviation;  ///< in: each cell's own deviation
    std::span<float> radius;     ///< in: corner_distance() of cells that lack a child diamond, else 0
    std::span<const glm::vec3> rounded;
    std::span<const std::uint8_t> exists;

    /// Raises record i over the diamonds of its two children in the same tile; 0 if it does not exist.
    void raise(unsigned i) const;
    /// Gives both cells of the diamond i inside the tile the larger numbers.
    void join(unsigned i, unsigned beyond) const;
};

}  // namespace planet
