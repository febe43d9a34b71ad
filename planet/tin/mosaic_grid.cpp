#include "planet/tin/mosaic_grid.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"

namespace planet {

namespace {

constexpr std::size_t samples_at_once = std::size_t{1} << 20;

// In place. @return how far rounding to float moves a height at most, metres
double metres_from_samples(std::span<float> samples, const RasterHeader& raster) {
    const bool as_they_are = raster.scale == 1 && raster.offset == 0;
    double rounding = 0;
    for (float& s : samples) {
        if (std::isinf(s)) s = 0;  // water
        if (as_they_are || std::isnan(s)) continue;
        const double metres = raster.offset + raster.scale * static_cast<double>(s);
        s = static_cast<float>(metres);
        rounding = std::max(rounding, std::abs(metres - static_cast<double>(s)));
    }
    return rounding;
}

}  // namespace

HeightGrid heights_of(const RasterMosaic& mosaic, const SampleWindow& window) {
    return {window.columns, window.rows, [&](std::span<float> out) {
                const auto columns = static_cast<std::size_t>(window.columns);
                const int rows_at_once = static_cast<int>(std::max<std::size_t>(1, samples_at_once / columns));
                double rounding = 0;
                for (int row = 0; row < window.rows; row += rows_at_once) {
                    const SampleWindow piece{window.column, window.row + row, window.columns,
                                             std::min(rows_at_once, window.rows - row)};
                    const auto samples = out.subspan(static_cast<std::size_t>(row) * columns, piece.count());
                    mosaic.read(piece, samples);
                    rounding = std::max(rounding, metres_from_samples(samples, mosaic.header()));
                }
                return rounding;
            }};
}

HeightGrid heights_of(const RasterMosaic& mosaic, std::size_t most) {
    const RasterHeader& raster = mosaic.header();
    const std::string size = std::to_string(raster.width) + "x" + std::to_string(raster.height) + " samples ";
    if (raster.width < 2 || raster.height < 2)
        throw Error(Fault::bad_data, raster.name, size + "have no area", "2x2 samples or more");
    if (raster.count() > most || std::max(raster.width, raster.height) > HeightGrid::max_side)
        throw Error(Fault::bad_data, raster.name, size + "are too many for one mesh",
                    "at most " + std::to_string(most) + "; with --tile any number");
    HeightGrid grid = heights_of(mosaic, {0, 0, raster.width, raster.height});
    if (grid.has_void() && grid.valid_samples() == 0)
        throw Error(Fault::bad_data, raster.name, "holds no heights: every sample is nodata", "one band of heights");
    return grid;
}

}  // namespace planet
