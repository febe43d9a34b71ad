#pragma once
// The dense pointerless quadtree of a tile: what lies below one cell, down to 12 bisections (6 quadtree levels).
//
// A *local* index names a cell of the tile: 1 is the root, 2i and 2i+1 the children of i; at relative level k the
// indices are 2^k .. 2^(k+1)-1, in Sierpinski order. Every cell with i < 2^depth can be split: record i of a tile
// belongs to the split vertex of cell i.
//
// A *vertex* index names a lattice vertex of the tile: 0 left, 1 right, 2 apex of the root, then the split vertices in
// the order in which local indices 1, 2, 3, ... first need them. A shallower tile so uses a prefix of the same order:
//
//     depth     1   2   3   4  ...   9   10   11    12
//     vertices  4   6   9  15  ... 289? see vertex_count(); a depth-12 tile has 65 x 66 / 2 = 2145
//
// The tables are the same for every tile on the planet, and are made once from the location code arithmetic.

#include <array>
#include <cstdint>

namespace planet {

inline constexpr int tile_levels = 12;
inline constexpr int tile_cells = 1 << tile_levels;  ///< local indices 1 .. tile_cells-1 can be split
inline constexpr int tile_vertices = 65 * 66 / 2;

struct TileLayout {
    /// Vertex index of the split vertex of local cell i, 1 <= i < tile_cells.
    std::array<std::uint16_t, tile_cells> split_vertex{};
    /// The two ends of the side that a vertex splits (for vertices 3...), the lesser index first.
    std::array<std::array<std::uint16_t, 2>, tile_vertices> ends{};
    /// The vertex indices of the corners left, right, apex of local cell i, 1 <= i < 2 * tile_cells.
    std::array<std::array<std::uint16_t, 3>, 2 * tile_cells> corners{};
    /// Position on the 64 x 64 lattice: apex (0,0), left (64,0), right (0,64).
    std::array<std::array<std::uint8_t, 2>, tile_vertices> lattice{};
    /// Local index of the cell across the split side of i, or 0 where that side lies on the tile's border.
    std::array<std::uint16_t, tile_cells> split_neighbor{};
    /// Number of vertices of a tile of depth 0..12.
    std::array<std::uint16_t, tile_levels + 1> vertex_count{};
};

/// The one table.
const TileLayout& tile_layout();

}  // namespace planet
