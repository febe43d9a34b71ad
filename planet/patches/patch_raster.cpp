#include "planet/patches/patch_raster.h"

#include <bit>
#include <cmath>

#include "planet/error.h"

namespace planet {

namespace {

PatchLattice lattice_for(const Raster& raster, std::size_t max_samples) {
    const std::string size = std::to_string(raster.width) + "x" + std::to_string(raster.height);
    if (raster.width < 2 || raster.height < 2)
        throw Error(Fault::bad_data, raster.name, size + " samples have no area", "2x2 samples or more");
    const auto steps_x = static_cast<unsigned>(raster.width - 1), steps_y = static_cast<unsigned>(raster.height - 1);
    const int k = static_cast<int>(std::bit_width(std::min(steps_x, steps_y) - 1));
    const auto patches = [k](unsigned steps) { return static_cast<int>((steps + (1u << k) - 1) >> k); };
    const auto samples = static_cast<std::size_t>(patches(steps_x)) * static_cast<std::size_t>(patches(steps_y))
                         << 2 * k;
    if (samples > max_samples)
        throw Error(Fault::bad_data, raster.name, size + " samples are too many for one mesh",
                    "at most " + std::to_string(max_samples) + " with the padding to patches; cut or reduce it");
    return {PatchGrid(patches(steps_x), patches(steps_y)), k};
}

}  // namespace

PatchRaster::PatchRaster(const Raster& raster, std::size_t max_samples)
    : lattice_(lattice_for(raster, max_samples)),
      width_(raster.width),
      height_(raster.height),
      heights_(raster.count() + readable_beyond) {
    std::size_t i = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x, ++i) {
            const double h = raster.at(x, y);
            heights_[i] = static_cast<float>(h);
            if (std::isnan(h)) continue;
            ++valid_;
            sample_rounding_ = std::max(sample_rounding_, std::abs(h - static_cast<double>(heights_[i])));
        }
    if (valid_ == 0) throw Error(Fault::bad_data, raster.name, "has no valid sample");
}

}  // namespace planet
