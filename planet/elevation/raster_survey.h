#pragma once
// What is known of a raster after one look at every sample.

#include <cstdint>
#include <functional>
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

/// The order in which a survey asks for samples: squares of `step` samples, row by row, in groups of this many a side.
/// A group should match what a file decodes at once.
struct SurveyOrder {
    int columns = 1, rows = 1;
};

/// Looks at every sample once. @param progress called after each row of groups with the fraction done, 0..1
RasterSurvey survey(const RasterSamples& samples, const SurveyOrder& order = {},
                    const std::function<void(double)>& progress = {});

/// Samples a side of the squares of a survey and of the blocks in which a raster is read.
inline constexpr int survey_step = 256;

}  // namespace planet
