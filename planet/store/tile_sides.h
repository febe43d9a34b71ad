#pragma once
// Which records of a tile it shares with the tiles beside it, and how records depend on each other.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/tile_layers.h"
#include "planet/octahedron/location_code.h"

namespace planet {

/// A cell whose split side lies on the border of its tile: its diamond is shared with another tile.
struct SideCell {
    std::uint16_t cell;  ///< local index
    Side side;           ///< of the tile's root
};

/// The side of the root on which the split side of a side cell lies.
inline Side side_of(unsigned side_cell) {
    const TileLayout& layout = tile_layout();
    const auto [u, v] = layout.lattice[layout.split_vertex[side_cell]];
    return u + v == 64 ? Side::split : v == 0 ? Side::left_leg : Side::right_leg;
}

/// The side cells of a tile of this depth, ascending: 189 in a full tile.
std::span<const SideCell> side_cells(int depth);

/// Relative level of a local index.
inline int relative_level(unsigned local) {
    return std::bit_width(local) - 1;
}

/// The code of local cell i below a root.
inline LocationCode cell_code(LocationCode root, unsigned i) {
    const int level = relative_level(i);
    return LocationCode(root.bits() << level | (i ^ 1u << level));
}

/// A cell by the tile that holds its record.
struct CellInTile {
    LocationCode root;
    unsigned local;
};

/// The tile and local index of a cell.
inline CellInTile cell_in_tile(LocationCode cell, TileLayers layers) {
    const int level = cell.bisection_level() - layers.root_level(cell.bisection_level());
    return {LocationCode(cell.bits() >> level),
            1u << level | (static_cast<unsigned>(cell.bits()) & ((1u << level) - 1))};
}

/// The local index, in the tile beside, of the other cell of a side cell's diamond: the path below the root is
/// complemented.
inline unsigned local_across(unsigned local) {
    return local ^ ((1u << relative_level(local)) - 1);
}

/// Which diamonds of a tile exist, given those on its sides. @param on_side by side cell @param exists by local index,
/// 2^depth of them. A diamond inside exists if both its parents do.
void existence_inside(int depth, std::span<const std::uint8_t> on_side, std::span<std::uint8_t> exists);

}  // namespace planet
