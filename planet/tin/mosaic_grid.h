#pragma once
// Heights for a triangulation, straight from files: whole, or in windows of rasters that memory does not hold.

#include "planet/elevation/raster_mosaic.h"
#include "planet/tin/height_grid.h"

namespace planet {

/// Four bytes a sample, and nothing beside them while they are read. Water is height 0. Safe from several threads.
/// @param window of at least two samples a side, within the mosaic; may be all void
HeightGrid heights_of(const RasterMosaic& mosaic, const SampleWindow& window);

/// All of it. Throws Error(bad_data) if it is one sample wide or high, has no valid sample, or more than `most` samples.
HeightGrid heights_of(const RasterMosaic& mosaic, std::size_t most);

}  // namespace planet
