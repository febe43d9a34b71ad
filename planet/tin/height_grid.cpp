#include "planet/tin/height_grid.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "planet/error.h"

namespace planet {

HeightGrid::HeightGrid(const Raster& raster) : width_(raster.width), height_(raster.height) {
    const std::string size = std::to_string(width_) + "x" + std::to_string(height_);
    if (width_ < 2 || height_ < 2)
        throw Error(Fault::bad_data, raster.name, size + " samples have no area", "2x2 samples or more");
    if (width_ > max_side || height_ > max_side)
        throw Error(Fault::bad_data, raster.name, size + " samples are too many for one side",
                    "at most " + std::to_string(max_side));
    heights_.resize(raster.count() + readable_beyond);
    std::size_t i = 0, valid = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x, ++i) {
            const double h = raster.at(x, y);
            heights_[i] = static_cast<float>(h);
            if (std::isnan(h)) continue;
            ++valid;
            whole_metres_ = whole_metres_ && is_whole(heights_[i]);
            sample_rounding_ = std::max(sample_rounding_, std::abs(h - static_cast<double>(heights_[i])));
        }
    if (valid == 0) throw Error(Fault::bad_data, raster.name, "has no valid sample");
    has_void_ = valid < raster.count();
}

HeightGrid::HeightGrid(const HeightGrid& whole, glm::ivec2 low, glm::ivec2 high)
    : width_(high.x - low.x + 1), height_(high.y - low.y + 1), sample_rounding_(whole.sample_rounding_) {
    assert(whole.inside(low) && whole.inside(high) && width_ >= 2 && height_ >= 2);
    heights_.resize(count() + readable_beyond);
    for (int y = 0; y < height_; ++y)
        std::copy_n(whole.row(low.y + y) + low.x, width_, heights_.begin() + std::ptrdiff_t{y} * width_);
    whole_metres_ = whole.whole_metres_;
    has_void_ = whole.has_void_ && std::any_of(heights_.begin(), heights_.end(), [](float h) { return std::isnan(h); });
}

HeightGrid::HeightGrid(int width, int height) : width_(width), height_(height), has_void_(true) {
    assert(width >= 2 && height >= 2);
    heights_.resize(count() + readable_beyond, std::numeric_limits<float>::quiet_NaN());
}

HeightGrid::HeightGrid(int width, int height, const std::function<double(std::span<float>)>& fill)
    : width_(width), height_(height) {
    assert(width >= 2 && height >= 2);
    heights_.resize(count() + readable_beyond);
    const std::span samples(heights_.data(), count());
    sample_rounding_ = fill(samples);
    has_void_ = std::any_of(samples.begin(), samples.end(), [](float h) { return std::isnan(h); });
}

std::size_t HeightGrid::valid_samples() const {
    if (!has_void_) return count();
    return static_cast<std::size_t>(std::count_if(heights_.begin(),
                                                  heights_.begin() + static_cast<std::ptrdiff_t>(count()),
                                                  [](float h) { return !std::isnan(h); }));
}

}  // namespace planet
