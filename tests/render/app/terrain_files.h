#pragma once
// Small rasters and features as files, for tests of `octaglobe mesh`.

#include <cmath>
#include <numbers>
#include <string>

#include "tests/planet/raster_files.h"
#include "tests/render/app/scratch_folder.h"

namespace render {

/// A raster of floats whose samples lie at `first` + column * step.x, row * step.y.
struct Terrain {
    int width = 41, height = 33;
    std::string crs = "EPSG:4326";
    double x = 10, y = 50, step_x = 0.01, step_y = -0.01;
    std::function<double(int column, int row)> height_m = nullptr;
    std::string band = "";  ///< further elements of the band

    void write(const std::filesystem::path& path) const {
        const planet::testing::RasterFile file{
            width, height, crs, {x - step_x / 2, step_x, 0, y - step_y / 2, 0, step_y}, band};
        planet::testing::write_raster<float>(
            path.string(), file, [&](int column, int row) { return static_cast<float>(height_m(column, row)); });
    }
};

/// Whole metres, 480 to 1,120.
inline double hills(int column, int row) {
    return std::round(800 + 300 * std::sin(0.3 * column) * std::cos(0.2 * row) + 20 * std::sin(2.1 * column + row));
}

inline Terrain hilly_terrain() {
    Terrain terrain;
    terrain.height_m = hills;
    return terrain;
}

inline void write_features(const std::filesystem::path& path, const std::string& geometries) {
    std::ofstream(path) << R"({"type":"GeometryCollection","geometries":[)" << geometries << "]}";
}

}  // namespace render
