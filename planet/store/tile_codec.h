#pragma once
// A tile as bytes, and back. The format is described in README.md beside this file.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/tile.h"
#include "planet/store/baked_tile.h"
#include "planet/store/lattice_code.h"

namespace planet {

/// What a store says once for all its tiles.
struct TileScale {
    Placement placement;          ///< at exaggeration 1
    double quantum_m = 0.25;      ///< of heights: a power of two
    bool has_undulation = false;  ///< whether tiles hold the datum's height above the ellipsoid
    TileLayers layers = {};
    std::uint32_t files = 0;  ///< of all sources: none is numbered higher
};

/// Undulations are whole multiples of this at vertices that split cells of levels below undulation_level (2.7 km apart
/// on Earth); at finer vertices they are the mean of the two
/// ends, rounded to float. EGM96 bends by less than 3 mm in between.
inline constexpr double undulation_quantum_m = 1.0 / 32;
inline constexpr int undulation_level = 24;

/// How many vertices of a tile have an undulation of their own.
std::size_t own_undulations(LocationCode root, int depth);
/// Fills the undulations of the finer vertices from those before them. @param undulation by vertex index
void interpolate_undulations(LocationCode root, int depth, std::span<GeoidUndulation> undulation);

/// Least and largest height over the tile's own existing vertices.
void own_height_range(Tile& tile, std::span<const std::uint8_t> exists);

/// The bytes of a settled tile.
std::vector<std::uint8_t> encode_tile(const BakedTile& baked, const TileScale& scale);

/// Throws MalformedBytes, saying what is wrong, if these are not the bytes of the tile below `root`: any damage is
/// found by the checksum. Safe to call from several threads.
Tile decode_tile(LocationCode root, std::span<const std::uint8_t> bytes, const TileScale& scale);

}  // namespace planet
