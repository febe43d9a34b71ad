#pragma once
// Which tiles a bake makes.
//
// A tile is *wanted* where the field is finer than the lattice above it. The lattice of a wanted tile can be refined
// fully only if every diamond it depends on exists, and these lie in up to 16 tiles, some of which touch it at a corner
// only or not at all: such tiles are *padding*, as deep as they are needed. They are found by following every
// dependency of the cells on the wanted tiles' sides with code arithmetic.

#include <cstddef>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/octahedron/location_code.h"

namespace planet {

struct PlannedTile {
    LocationCode root;
    int depth;  ///< 1..12
    bool has_children;
};

struct CoverageLimits {
    double mean_radius_m = 6371008.8;
    int least_level = 12;                             ///< the whole planet has cells at least this fine
    int finest_level = 60;                            ///< nothing is finer, whatever the field's spacing
    int extra_levels = 0;                             ///< added to what the field's spacing asks for
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< of the tiles in memory; see planned_bytes()
};

/// An upper bound of the memory a bake holds for one tile.
std::size_t planned_bytes(const PlannedTile& tile);

/// The tiles of a bake, ascending by code (so parents come first). The eight faces are always among them.
/// Throws Error(bad_usage) when they need more memory than allowed.
std::vector<PlannedTile> coverage(const ElevationField& field, const CoverageLimits& limits);

/// A cap that holds the cell.
Cap cap_of(LocationCode cell);

}  // namespace planet
