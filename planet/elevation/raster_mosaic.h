#pragma once
// Raster files that share a grid, read in windows as if they were one. A single file is a mosaic of one.

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "planet/elevation/raster_io.h"

namespace planet {

/// One file of a mosaic: where its samples lie in it, and how they are read.
struct MosaicPart {
    std::string path;
    RasterHeader header;
    SampleWindow window{};
    std::vector<std::string> files{};  ///< what it is read from
    bool may_be_shorts = false;
    std::size_t decoded_bytes = 0;  ///< RasterReader::decoded_bytes of a block of samples
    int natural_columns = 1, natural_rows = 1;
};

/// Opens a file and reads what a mosaic needs to know of it. Its window starts at 0, 0.
MosaicPart mosaic_part(const std::string& path, const RasterOptions& options = {});

/// Moves a part's window to where it lies on the grid of another one, relative to that one's window. False, and nothing
/// is changed, unless both have the same CRS, axes and sample distances, and lie a whole number of samples apart, to
/// 1/50 of a sample.
bool place_on_grid_of(const MosaicPart& other, MosaicPart& part);

/// Where files overlap, the later one is on top, except where it is void. Where there is no file the samples are void.
/// Safe from several threads: each reads only through files that it opened itself, of which a few are kept open. GDAL lets
/// what one thread opens twice share one position in the file (.vrt over raw samples, sources of a .vrt), so an open file
/// that is handed to another thread may read elsewhere than it was told.
class RasterMosaic {
  public:
    /// @param parts  at least one, placed on one grid
    /// @param name   of the mosaic; the name of the file if there is one
    RasterMosaic(std::vector<MosaicPart> parts, std::string name, RasterOptions options = {});

    /// Without a checksum. Heights in metres (scale 1) unless all parts have the same scale and offset.
    const RasterHeader& header() const { return header_; }
    const std::vector<MosaicPart>& parts() const { return parts_; }
    bool may_be_shorts() const { return may_be_shorts_; }
    /// Of the parts' files, below the folder that all of them share.
    std::vector<std::string> file_names() const;

    /// Samples as Raster has them. False if a value does not fit.
    bool read(const SampleWindow& window, std::span<std::int16_t> out) const;
    void read(const SampleWindow& window, std::span<float> out) const;
    /// The part that all samples of a window are of, but for void ones, if no other one meets it.
    std::optional<std::uint32_t> only_part(const SampleWindow& window) const;
    /// Which part each sample of a window is of; nothing is meant by what a void sample gets. Reads only those parts that
    /// lie over others there.
    void find_parts(const SampleWindow& window, std::span<std::uint32_t> out) const;

    /// Throws Error(bad_data) if a file of a part has changed its size or time, or is gone, since the mosaic was made.
    void check_unchanged(const MosaicPart& part) const;

  private:
    struct Idle {
        const MosaicPart* part;
        std::thread::id opened_by;
        std::unique_ptr<RasterReader> reader;
    };
    class Borrowed;
    struct Stamp {
        std::uintmax_t bytes;
        std::filesystem::file_time_type time;
        bool operator==(const Stamp&) const = default;
    };

    static std::optional<Stamp> stamp_of(const std::string& file);
    void index_parts();
    std::vector<std::uint32_t> parts_in(const SampleWindow& window) const;
    template <class Sample>
    bool read_samples(const SampleWindow& window, std::span<Sample> out) const;
    template <class Sample>
    bool read_part(const MosaicPart& part, const SampleWindow& window, std::span<Sample> out) const;

    std::vector<MosaicPart> parts_;
    RasterOptions options_;
    RasterHeader header_;
    bool may_be_shorts_ = false, in_metres_ = false;
    std::map<std::string, Stamp> stamps_;
    int cell_columns_ = 1, cell_rows_ = 1;  // of the index
    std::map<std::pair<int, int>, std::vector<std::uint32_t>> index_;

    mutable std::mutex mutex_;
    mutable std::vector<Idle> idle_;  // most recently used last
};

/// All of a mosaic in memory, with its checksum. Throws Error if nothing but voids is in it.
Raster read_mosaic(const RasterMosaic& mosaic);

}  // namespace planet
