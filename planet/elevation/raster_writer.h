#pragma once
// Rasters as GeoTIFF files, through GDAL, which is in a module of its own (module.h).

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "planet/elevation/make_file.h"
#include "planet/elevation/raster_io.h"

namespace planet {

/// What the module implements: an open file that takes windows in any order.
class RasterSink {
  public:
    virtual ~RasterSink() = default;
    /// Throws Error(bad_usage) if the samples cannot be written.
    virtual void write(const SampleWindow& window, std::span<const float> samples) = 0;
    /// After the last window. Throws Error(bad_usage) if some bytes could not be written.
    virtual void close() = 0;
};
class RasterSinkDriver {
  public:
    virtual ~RasterSinkDriver() = default;
    /// @param file that is made @param shown_as its name in errors
    virtual std::unique_ptr<RasterSink> create(const std::string& file, const std::string& shown_as,
                                               const RasterHeader& raster) const = 0;
};

/// Writes a raster of 32-bit floats on the grid and in the CRS of another one; NaN is its nodata value, and what is not
/// written. Compressed without loss. The file appears under its name, whole, at finish(); before that it is a temporary
/// one beside it, which is removed if the writer is destroyed first.
class RasterWriter {
  public:
    /// Throws Error(bad_usage) for a name that does not end in .tif or .tiff, or a place that cannot be written.
    /// @param make_file makes the temporary file
    RasterWriter(const std::string& path, const RasterHeader& like, const MakeFile& make_file = {});
    ~RasterWriter();
    RasterWriter(const RasterWriter&) = delete;
    RasterWriter& operator=(const RasterWriter&) = delete;

    /// In any order. @param samples row-major. Throws Error(bad_usage) if they cannot be written.
    void write(const SampleWindow& window, std::span<const float> samples);
    /// The file is there. Throws Error(bad_usage) if it cannot be.
    void finish();

  private:
    std::string shown_as_;
    std::filesystem::path file_, temporary_;
    std::shared_ptr<void> made_;
    std::unique_ptr<RasterSink> sink_;
};

}  // namespace planet
