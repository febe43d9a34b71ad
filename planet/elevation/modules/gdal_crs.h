#pragma once
// Reference systems through GDAL and PROJ.

#include <ogr_spatialref.h>

#include <memory>

#include "planet/elevation/raster.h"

namespace planet {

/// Sets crs, radius_m and transform of a raster whose size and grid are set. The transform stays null where x and y are
/// already longitude and latitude of WGS84 (or of the planet that the CRS is on) to 1e-9 degrees.
/// Throws Error if PROJ knows no way.
void set_crs(Raster& raster, OGRSpatialReference& crs, const std::string& path);

}  // namespace planet
