#pragma once
// What resampling lost: the largest distance of a source sample from the finest surface.

#include <functional>
#include <span>

#include "planet/elevation/elevation_field.h"
#include "planet/store/baked_tile.h"

namespace planet {

/// Sets Tile::resampling of every tile, metres, rounded up: the largest |height of a sample - finest surface| over the
/// field's samples where the tile is the finest. Samples are asked for in caps of at most about a million.
void certify_resampling(const ElevationField& field, const Placement& placement, std::span<BakedTile> tiles,
                        const std::function<void(double fraction)>& progress);

}  // namespace planet
