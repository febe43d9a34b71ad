#include "planet/elevation/surface_field.h"

#include <cmath>

#include "planet/elevation/sha256.h"
#include "planet/error.h"

namespace planet {
namespace {

void check_same_grid(const Raster& heights, const Raster& mask) {
    const auto size = [](const Raster& r) { return std::to_string(r.width) + "x" + std::to_string(r.height); };
    if (mask.width != heights.width || mask.height != heights.height)
        throw Error(Fault::bad_data, mask.name, "the mask has " + size(mask) + " samples", size(heights));
    for (const glm::dvec2 corner : {glm::dvec2(0), glm::dvec2(heights.width - 1, heights.height - 1)}) {
        const glm::dvec2 apart = glm::abs(mask.grid.crs_from_sample(corner) - heights.grid.crs_from_sample(corner));
        const glm::dvec2 sample = glm::abs(heights.grid.per_column) + glm::abs(heights.grid.per_row);
        if (!(apart.x <= 0.02 * sample.x && apart.y <= 0.02 * sample.y) || mask.crs != heights.crs)
            throw Error(Fault::bad_data, mask.name, "the mask lies elsewhere than " + heights.name, "the same grid");
    }
}

template <class Sample>
void drown(std::vector<Sample>& samples, Sample water, const Raster& mask) {
    std::size_t i = 0;
    for (int row = 0; row < mask.height; ++row)
        for (int column = 0; column < mask.width; ++column, ++i) {
            const double land = mask.at(column, row);
            if (land == 0)
                samples[i] = water;
            else if (land != 1 && !std::isnan(land))
                throw Error(Fault::bad_data, mask.name,
                            "holds " + std::to_string(land) + " at column " + std::to_string(column) + ", row " +
                                std::to_string(row),
                            "a mask of 0 (water) and 1 (land)");
        }
}

}  // namespace

std::shared_ptr<const RasterField> make_surface_field(Raster heights, const Raster& land_mask, VerticalDatum datum) {
    check_same_grid(heights, land_mask);
    if (auto* shorts = std::get_if<std::vector<std::int16_t>>(&heights.samples))
        drown(*shorts, water_sample, land_mask);
    else
        drown(std::get<std::vector<float>>(heights.samples), -std::numeric_limits<float>::infinity(), land_mask);
    Sha256 sum;
    for (const std::string& part : {heights.checksum, land_mask.checksum}) sum.add(part.data(), part.size());
    heights.checksum = sum.hex();
    return std::make_shared<RasterField>(std::make_shared<const Raster>(std::move(heights)), datum);
}

}  // namespace planet
