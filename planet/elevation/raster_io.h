#pragma once
// Reading elevation files through GDAL, which is in a module of its own (module.h).

#include <cstdint>
#include <string>

#include "planet/elevation/raster.h"

namespace planet {

struct RasterOptions {
    /// The largest number of samples kept in memory (2 bytes each, 4 where a source needs floats).
    std::int64_t max_samples = std::int64_t{512} << 20;
    /// A larger file: refused, or read with every n-th row and column, the least odd n that fits (its overviews are
    /// used where it has them). The raster says so in `reduction`.
    bool reduce = false;
    /// For a file that does not name its CRS, e.g. "EPSG:32633". Without it such a file is taken for WGS84 longitude
    /// and latitude if its coordinates fit, else refused.
    std::string crs_if_missing;
    /// Accepts a raster that is nowhere on a planet, e.g. a heightmap in a grey PNG; it says so in Raster::plain. With no
    /// georeference its grid is x = column, y = -row of the file; with one that has no CRS, or one that is local or
    /// unknown to PROJ, the grid is in the file's own coordinates, even if they could be longitude and latitude.
    bool plain = false;
};

/// Reads a DEM: any format, CRS and band type that GDAL reads, one band (and an alpha band or mask), 8 to 64 bit
/// integers or floats, scale and offset, heights in metres or in feet if the file says so. Void are the file's nodata
/// value, masked pixels, NaN, infinities, and everything farther than 1000 km from 0 (unmarked fill values).
///
/// Throws Error for whatever is not that: no such file, empty, damaged, no raster, no georeference (unless `plain`), a picture, larger
/// than max_samples, or nothing but nodata. Writes no files beside the source.
/// @param path a file, or a name that GDAL knows ("NETCDF:relief.nc:height", "/vsizip/...").
Raster read_raster(const std::string& path, const RasterOptions& options = {});

/// What the module implements.
class RasterDriver {
  public:
    virtual ~RasterDriver() = default;
    /// Everything but the checksum, and in `files` the files that it was read from.
    virtual Raster read(const std::string& path, const RasterOptions& options,
                        std::vector<std::string>& files) const = 0;
    virtual std::string version() const = 0;  ///< "GDAL 3.6.2"
};

/// GDAL's name and version; throws Error if the module cannot be loaded.
std::string raster_library_version();

}  // namespace planet
