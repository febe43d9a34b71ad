#pragma once
// Heights of a raster, or of a window of it, as a triangulation reads them.

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/elevation/raster.h"

namespace planet {

/// Metres, row by row, NaN where void. Four bytes a sample: what it was made from may go.
class HeightGrid {
  public:
    /// Longest side of a grid, samples.
    static constexpr int max_side = 1 << 24;

    /// Throws Error(bad_data) for a raster that is one sample wide or high, or has no valid sample.
    explicit HeightGrid(const Raster& raster);
    /// A window of another grid. @param low, high its first and last sample: at least two a side
    HeightGrid(const HeightGrid& whole, glm::ivec2 low, glm::ivec2 high);
    /// All void. @param width, height at least 2
    HeightGrid(int width, int height);
    /// @param width, height at least 2 @param fill writes all heights, in rows, where they will stay, and returns
    /// sample_rounding()
    HeightGrid(int width, int height, const std::function<double(std::span<float>)>& fill);

    int width() const { return width_; }    ///< samples
    int height() const { return height_; }  ///< samples
    std::size_t count() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
    bool has_void() const { return has_void_; }
    std::size_t valid_samples() const;
    /// Largest |height of the source - height here|, metres: floats hold whole metres and most else exactly.
    double sample_rounding() const { return sample_rounding_; }

    /// Whether every height is a whole number of metres below 2^22: differences of two are whole numbers too.
    bool whole_metres() const { return whole_metres_; }

    /// Eight floats beyond the end may be read.
    const float* row(int y) const {
        return heights_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    }
    float at(glm::ivec2 p) const { return row(p.y)[p.x]; }
    bool valid(glm::ivec2 p) const { return !std::isnan(at(p)); }
    bool inside(glm::ivec2 p) const { return p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_; }
    /// @param height metres, or NaN
    void set(glm::ivec2 p, float height) {
        heights_[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(p.x)] =
            height;
        has_void_ = has_void_ || std::isnan(height);
        whole_metres_ = whole_metres_ && (std::isnan(height) || is_whole(height));
    }

  private:
    static bool is_whole(float height) { return std::abs(height) < 0x1p22f && height == std::floor(height); }

    static constexpr std::size_t readable_beyond = 8;

    int width_, height_;
    bool has_void_ = false, whole_metres_ = true;
    double sample_rounding_ = 0;
    std::vector<float> heights_;
};

}  // namespace planet
