#pragma once
// The settling of one tile, given what the tiles beside it say of the records they share with it.
//
// A record (deviation and radius of a diamond) becomes at least those of its child diamonds; where two tiles hold a
// diamond, both take the larger numbers, on the ladder. Everything is a maximum of what is finer, so the result is one,
// whatever the order in which tiles are settled and told of each other.

#include <array>
#include <cstdint>
#include <span>

#include "planet/mesh/deviation.h"
#include "planet/mesh/tile.h"
#include "planet/store/tile_sides.h"

namespace planet {

/// The record of a side cell in steps of the ladders; 0, 0 if its diamond does not exist.
struct SideSteps {
    std::uint16_t deviation = 0;
    std::uint16_t radius = 0;
};

/// By side cell of a full tile (tile_sides.h), the same diamond's place among the side cells of the tile across that side:
/// the path below the root is complemented. A shallower tile has a prefix of both.
const std::array<std::uint16_t, 189>& side_cells_across();

/// What can still change of a tile that is not settled: the records by vertex index, that of the split vertex of their
/// diamond.
struct TileRecords {
    int depth = 0;
    bool inner = false;                               ///< has tiles below: rounds deviations up the ladder
    std::array<glm::vec3, tile_vertices> position{};  ///< rounded: m of the split test
    /// Before settle(): each diamond's own, metres; 0 where it does not exist.
    std::array<float, tile_vertices> deviation{}, radius{};

    /// Takes the larger numbers of both cells of each diamond for its own record. Spans are by local index.
    void set_own(std::span<const float> deviation, std::span<const float> radius, std::span<const std::uint8_t> exists);

    /// Settles the tile from its own records. @param theirs by side cell: what the tiles beside it arrived at so far
    /// @param mine by side cell: what this tile arrives at
    void settle(std::span<const SideSteps> theirs, std::span<SideSteps> mine);

    /// The same for a settled tile after `theirs` have risen; visits what they change. @param mine in and out
    void rise(std::span<const SideSteps> theirs, std::span<SideSteps> mine);
};

}  // namespace planet
