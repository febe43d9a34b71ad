#pragma once
// A raster of any size, read in blocks when they are needed.

#include <functional>
#include <memory>

#include "planet/elevation/block_cache.h"
#include "planet/elevation/raster_mosaic.h"
#include "planet/elevation/raster_survey.h"

namespace planet {

/// Holds nothing but the survey and what the cache keeps. Blocks have block_size samples a side and as many beside them as
/// interpolation needs, so that few positions need more than one.
class BlockedRaster final : public RasterSamples {
  public:
    /// Reads every sample once, which finds out whether 16-bit samples do, makes the survey, and has the files' bytes
    /// hashed while they are still in the system's cache.
    /// Throws Error for a file that cannot be read somewhere, or where all is void.
    /// @param progress called from time to time with the fraction done, 0..1
    BlockedRaster(std::shared_ptr<const RasterMosaic> mosaic, std::shared_ptr<BlockCache> cache,
                  const std::function<void(double)>& progress = {});

    const RasterHeader& header() const override { return header_; }
    SampleView view(int column, int row) const override;
    const RasterSurvey& survey() const { return survey_; }

    /// Samples a side of a block.
    static constexpr int block_size = 256;

  private:
    void survey_all(const std::function<void(double)>& progress);
    SampleBlock read_block(int column, int row) const;
    SampleBlock read_window(const SampleWindow& window) const;
    std::string checksum_of_samples() const;

    std::shared_ptr<const RasterMosaic> mosaic_;
    std::shared_ptr<BlockCache> cache_;
    RasterHeader header_;
    int block_columns_;
    std::uint32_t id_;
    bool shorts_;
    RasterSurvey survey_;
};

}  // namespace planet
