#pragma once
// Which tiles a bake makes.
//
// A tile is *wanted* where the field is finer than the lattice above it. The lattice of a wanted tile can be refined
// fully only if every diamond it depends on exists, and these lie in up to 16 tiles, some of which touch it at a corner
// only or not at all: such tiles are *padding*, as deep as they are needed. They are found by following every
// dependency of the cells on the wanted tiles' sides with code arithmetic.

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/tile_sides.h"

namespace planet {

/// A byte and a bit for each tile, in blocks of the up to 4096 places below one tile.
class TilePlan {
  public:
    explicit TilePlan(TileLayers layers = {}) : layers_(layers) {}

    /// Where tiles begin.
    TileLayers layers() const { return layers_; }
    /// How many levels of cells of a tile can be split, 1..12; 0: there is no such tile.
    int depth(LocationCode root) const;
    bool contains(LocationCode root) const { return depth(root) > 0; }
    /// Whether every diamond of the tile exists, whatever is around it.
    bool is_whole(LocationCode root) const;
    bool has_tiles_below(LocationCode root) const { return blocks_.contains(root.bits()); }
    /// Whether some tile holds a record for the cell; in a whole part of it, its diamond exists.
    bool has_record(LocationCode cell) const;
    bool is_in_whole_part(LocationCode cell) const;
    /// The roots of the tiles below a tile, ascending.
    std::vector<LocationCode> below(LocationCode root) const;

    std::uint64_t tiles() const { return tiles_; }
    const std::map<int, std::uint64_t>& vertices_by_level() const { return vertices_by_level_; }  ///< of their roots
    std::uint64_t vertices() const { return vertices_; }  ///< of all tiles, those that tiles share counted in each
    int finest_level() const { return finest_level_; }
    std::size_t bytes() const { return blocks_.size() * (sizeof(Block) + 64); }

    /// A mark that the bake sets on tiles whose records can no longer change.
    bool is_final(LocationCode root) const;
    void mark_final(LocationCode root);

  private:
    friend class CoveragePlanner;
    struct Depths {
        std::uint8_t wanted : 4 = 0;  ///< every diamond of cells above this depth exists
        std::uint8_t needed : 4 = 0;  ///< some must, for other tiles
        int any() const { return wanted > needed ? wanted : needed; }
    };
    struct Block {
        std::array<Depths, tile_cells> depths{};
        std::bitset<tile_cells> final;
    };
    struct Place {
        std::uint64_t block;
        std::size_t index;
    };
    Place place(LocationCode root) const;
    LocationCode root_at(std::uint64_t block, std::size_t index) const;
    Depths at(LocationCode root) const;
    void count();

    TileLayers layers_;
    // By the bits of the tile above; the faces are in block 0, by their bits.
    std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
    std::uint64_t tiles_ = 0, vertices_ = 0;
    std::map<int, std::uint64_t> vertices_by_level_;
    int finest_level_ = 0;
};

struct CoverageLimits {
    double mean_radius_m = 6371008.8;
    int least_level = 12;                             ///< the whole planet has cells at least this fine
    int finest_level = 60;                            ///< nothing is finer, whatever the field's spacing
    int extra_levels = 0;                             ///< added to what the field's spacing asks for
    int first_tile_level = 0;                         ///< TileLayers::first; 0: cheapest_layers()
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< of the plan while it is made
};

/// The bisection level that the field's spacing and the limits ask for in a cell.
int finest_level_in(const Corners& cell, const ElevationField& field, const CoverageLimits& limits);

/// The tiles of a bake. The eight faces are always among them, and with a tile the one above it.
/// Throws Error(bad_usage) when the plan needs more memory than allowed.
TilePlan coverage(const ElevationField& field, const CoverageLimits& limits);

}  // namespace planet
