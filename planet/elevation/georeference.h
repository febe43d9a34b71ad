#pragma once
// Where a picture lies, by what its file says (GeoTIFF) or a world file beside it, through GDAL.

#include <optional>
#include <string>

#include "planet/elevation/raster.h"

namespace planet {

/// Size, grid and CRS of a file of any bands; `plain` if it names no CRS that PROJ knows. Nothing if it has no place, only
/// control points, or GDAL does not read it.
std::optional<RasterHeader> georeference_of(const std::string& path);

}  // namespace planet
