#pragma once
// What is known of a raster after one look at every sample.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/elevation/raster_samples.h"

namespace planet {

/// Takes about a byte for 64 x 64 samples of a raster of up to 32,768 samples a side, and no more than 2^18 bytes for a
/// larger one. The same whether the raster is in memory or read in blocks.
struct RasterSurvey {
    enum class Fill : std::uint8_t { none, some, all };  ///< of a block's samples

    int columns = 0;     ///< of the raster, without one that repeats the first
    int block_size = 0;  ///< samples a side
    int block_columns = 0, block_rows = 0;
    std::vector<Fill> fill;  ///< row-major
    /// Means of the first and the last row in the units of samples, water as height 0; NaN where all is void. Only of
    /// rasters that reach the pole there.
    float first_mean = std::numeric_limits<float>::quiet_NaN();
    float last_mean = std::numeric_limits<float>::quiet_NaN();
    std::size_t border_sides = 0;  ///< sides of pixels with a height beyond which there is none

    Fill fill_at(int column, int row) const {
        return fill[static_cast<std::size_t>(row) * static_cast<std::size_t>(block_columns) +
                    static_cast<std::size_t>(column)];
    }
    bool empty() const;
};

/// Collects a survey from windows of samples.
class Surveyor {
  public:
    explicit Surveyor(const RasterHeader& raster);

    /// Windows come in bands, from the first row to the last; in a band they have the same rows and go from the first
    /// column to the last, without gaps. @param view  its window; one that goes around may have the repeated column
    void add(const SampleView& view);
    RasterSurvey finish();

  private:
    void mark(const SampleView& view, int row, std::span<std::uint8_t> held) const;
    void count_border(int column, int row, std::span<const std::uint8_t> held);
    void count_blocks(int column, int row, std::span<const std::uint8_t> held);
    void add_to_means(const SampleView& view, int row);

    RasterHeader raster_;
    int around_;
    Poles poles_;
    RasterSurvey out_;
    std::vector<std::int64_t> counts_;            // by block: samples that hold a height
    std::vector<std::uint8_t> held_, row_above_;  // of one row of a window; of the last row of each column so far
    std::vector<std::uint8_t> left_, first_;      // by row of the band: column before the window, first column
    struct Mean {
        double sum = 0;
        int count = 0;
    } first_mean_, last_mean_;
};

/// Of a raster in memory.
RasterSurvey survey(const RasterSamples& whole);

}  // namespace planet
