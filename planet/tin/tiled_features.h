#pragma once
// Features of a raster that is made in tiles, cut where tiles meet.

#include <unordered_map>

#include "planet/tin/tiled_tin.h"

namespace planet {

/// What each tile needs of the features, in samples of the raster; tiles without any are left out. A line that crosses a
/// border is cut at the sample of the border nearest to the crossing, and so bends there by half a sample at most. All
/// vertices on borders are among the needs of every tile that has them; each point, and each part of a line, is a feature
/// of one tile alone.
std::unordered_map<std::size_t, TinTileNeeds> cut_into_tiles(const TinFeatures& features, const TinTiling& tiling);

}  // namespace planet
