#pragma once
// A tile in memory: heights and certified deviations below one cell, down to 12 bisections. See tile_layout.h.

#include <bit>
#include <bitset>
#include <cstdint>
#include <vector>

#include "planet/elevation/height_origin.h"
#include "planet/frames.h"
#include "planet/mesh/tile_layers.h"
#include "planet/mesh/tile_layout.h"
#include "planet/octahedron/location_code.h"

namespace planet {

/// A diamond exists where both its cells' tiles have a record for it and its parents exist; where it does not,
/// deviation is 0 and the cell is never split. deviation and radius are *saturated*: at least those of every child
/// diamond, the same bits from both cells of a side, so that "split iff deviation > 0 and |eye - m| < radius + K
/// deviation" is nested: a vertex passes only if its parents pass, and any recursive walk is conforming.
struct Tile {
    LocationCode root;  ///< of a level at which tiles begin (tile_layers.h)
    int depth = 0;      ///< 1..12: cells with local index < 2^depth can be split
    /// By vertex index, vertex_count[depth] of them, metres: the height above the store's datum (H for egm96).
    std::vector<float> height;
    /// By vertex index, metres: the datum above the ellipsoid (N for egm96), so that h = height + undulation. Empty: 0.
    std::vector<GeoidUndulation> undulation;
    /// By vertex index: where the height came from.
    OriginPlane origins;
    /// By local index, 2^depth of them (0 unused): the largest distance in metres, along the geodetic normal, between
    /// the plane of either cell of the diamond and any finest vertex below; saturated.
    std::vector<float> deviation;
    /// By local index, metres: every vertex below the diamond lies within it of the diamond's split vertex (true
    /// height).
    std::vector<float> radius;
    /// Bit k: the cell at relative level `depth` and position k has a tile of its own.
    std::bitset<tile_cells> child_exists;
    /// By position k, metres: the saturated deviation and radius of the root's diamond of the tile below, known before
    /// that tile is loaded; 0 where there is none. 2^depth of them, or empty where there are no tiles below.
    std::vector<float> child_deviation, child_radius;
    float min_height = 0, max_height = 0;  ///< over every finest vertex below, metres
    /// Largest |source sample - lattice| over the source samples in the tile's own cells, metres. A bound on
    /// resampling.
    float resampling = 0;
    bool damaged = false;  ///< stands in for a tile that could not be read
};

}  // namespace planet
