#pragma once
// At which levels the tiles of a bake had better begin.

#include "planet/bake/coverage.h"

namespace planet {

/// The layers of tiles that make the smallest and quickest store of a field: those with whole tiles, or nearly whole ones,
/// where most of the finest cells are. An estimate: looks at the field in cells down to 4096 finest cells
/// each, and of a very large one at samples of those.
TileLayers cheapest_layers(const ElevationField& field, const CoverageLimits& limits);

}  // namespace planet
