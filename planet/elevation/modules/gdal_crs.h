#pragma once
// Reference systems through GDAL and PROJ.

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <memory>

#include "planet/elevation/raster.h"

namespace planet {

using Transformation = std::unique_ptr<OGRCoordinateTransformation, void (*)(OGRCoordinateTransformation*)>;

/// Null if PROJ knows no way.
Transformation make_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to);

/// Metres in a unit of height of a CRS; 1 if it has no vertical part, or is null.
double metres_per_height(const OGRSpatialReference* crs);

/// What the heights of a CRS are measured from: "EPSG:5773" or a name for a compound one, "ellipsoid" for one with three
/// axes, else empty. Null gives empty.
std::string vertical_of(const OGRSpatialReference* crs);

/// Sets the grid of a raster whose size is set. False if the file has none that is of use.
bool read_grid(GDALDataset& dataset, RasterHeader& raster);

/// Sets crs, radius_m and transform of a raster whose size and grid are set. The transform stays null where x and y are
/// already longitude and latitude of WGS84 (or of the planet that the CRS is on) to 1e-9 degrees.
/// Throws Error if PROJ knows no way.
void set_crs(RasterHeader& raster, OGRSpatialReference& crs, const std::string& path);

}  // namespace planet
