#pragma once
// Tiles while they are being baked, and the settling of what they share.

#include <array>
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
    Tile tile;
    std::vector<glm::vec3> rounded;      ///< by vertex index: m of the split test
    std::vector<std::uint8_t> exists;    ///< by local index
    std::vector<SideGain> gain;          ///< by side cell
    std::array<std::int32_t, 3> beside;  ///< by Side of the root: the tile of the same level there, -1: none
    std::int32_t above = -1;             ///< the tile that holds the root's cell
    std::vector<std::int32_t> below;     ///< by position at relative level 12, -1: none; empty for leaf tiles
    bool inner() const { return !below.empty(); }
};

/// Empty tiles for a plan, tied to each other, with their existence flags: a diamond exists iff both its cells have a
/// record and both its parents exist. @param plan ascending
std::vector<BakedTile> tie_tiles(const std::vector<PlannedTile>& plan);

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

/// Saturates every tile and settles their sides, from the finest level up, so that one pass is the fixpoint: a record
/// depends on finer ones only. Deviations of inner tiles and of sides are rounded up the ladder; so are the radii of
/// sides and of the finest diamonds of inner tiles.
void settle(std::span<BakedTile> tiles);

}  // namespace planet
