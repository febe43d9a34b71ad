#pragma once
// Reading elevation files through GDAL, which is in a module of its own (module.h).

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planet/elevation/raster.h"
#include "planet/elevation/sha256.h"

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

/// A rectangle of samples.
struct SampleWindow {
    int column = 0, row = 0;  ///< of the first
    int columns = 0, rows = 0;

    std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// An open raster, for one thread at a time. Samples are as in Raster: marked, in the units of scale and offset.
class RasterReader {
  public:
    virtual ~RasterReader() = default;
    /// All but name and checksum. Throws Error if the CRS is of no use.
    virtual RasterHeader header() const = 0;
    /// What it is read from.
    virtual std::vector<std::string> files() const = 0;
    /// Whether the type of its band is one whose values may fit 16-bit samples.
    virtual bool may_be_shorts() const = 0;
    /// How much of what GDAL decodes must be kept so that windows of a width of `columns` that follow each other along a
    /// row are not decoded again; bytes, 0 where windows are read as they lie in the file.
    virtual std::size_t decoded_bytes(int columns) const = 0;
    /// Samples that GDAL decodes at once.
    virtual int natural_columns() const = 0;
    virtual int natural_rows() const = 0;
    /// Reads a window into window.count() samples, row-major. False, and `out` of no use, if a value does not fit.
    /// Throws Error, which names the window, if it cannot be read.
    virtual bool read(const SampleWindow& window, std::span<std::int16_t> out) = 0;
    virtual void read(const SampleWindow& window, std::span<float> out) = 0;
};

/// What the module implements. Safe from several threads.
class RasterDriver {
  public:
    virtual ~RasterDriver() = default;
    /// Of the options it looks at max_samples only together with `reduce`.
    virtual std::unique_ptr<RasterReader> open(const std::string& path, const RasterOptions& options) const = 0;
    virtual std::string version() const = 0;  ///< "GDAL 3.6.2"
    /// The most memory that GDAL keeps decoded blocks in, of all files together; it is 5 % of the machine's otherwise.
    virtual void limit_cache(std::size_t bytes) const = 0;
};

/// The driver in the module; throws Error if it cannot be loaded.
const RasterDriver& raster_driver();

/// Opens a file as read_raster() does, without reading samples and without a limit to their number.
std::unique_ptr<RasterReader> open_raster(const std::string& path, const RasterOptions& options = {});

/// SHA-256 of the bytes of files, in the order of their names: for one file its own digest. Names that are no files are
/// left out; empty if nothing is left.
std::string checksum_of_files(std::vector<std::string> files);

/// Of the bytes of the files that a raster was read from; of its samples and place where there are no such files (e.g.
/// inside an archive). 64 hex digits.
std::string checksum_of(const Raster& raster, std::vector<std::string> files);

/// False if every sample is void.
bool holds_a_height(const Raster& raster);

/// What the checksum of a raster that is made of no files takes in after its samples.
void add_to_checksum(const RasterHeader& raster, Sha256& sum);

/// GDAL's name and version; throws Error if the module cannot be loaded.
std::string raster_library_version();

}  // namespace planet
