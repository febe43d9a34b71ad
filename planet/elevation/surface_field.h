#pragma once
// The surface that is drawn: land as it is, water flat at 0.

#include <memory>

#include "planet/elevation/raster_field.h"

namespace planet {

/// A field of height 0 where the mask is 0 and of the raster's heights where it is 1. Between land and water samples it
/// never goes below 0 unless the land does, and between four water samples it is exactly 0 (raster_surface.h): no
/// ripples on the sea below steep coasts. Heights of water samples are dropped; void heights stay void.
/// Throws Error(bad_data) unless both have the same grid and the mask is 0 or 1; a void of the mask counts as land.
std::shared_ptr<const RasterField> make_surface_field(Raster heights, const Raster& land_mask, VerticalDatum datum);

}  // namespace planet
