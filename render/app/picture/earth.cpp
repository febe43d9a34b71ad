#include "render/app/picture/earth.h"

#include <algorithm>

#include "planet/elevation/layered_field.h"
#include "planet/elevation/raster_field.h"
#include "planet/elevation/raster_io.h"
#include "planet/elevation/sha256.h"
#include "planet/elevation/surface_field.h"
#include "render/app/data_path.h"

namespace render {
namespace {

using planet::VerticalDatum;

// Of the shipped data (data/README.md).
constexpr const char* relief_file = "etopo5.tif";
constexpr const char* land_file = "land_mask.tif";  // same grid, 1 on land
constexpr const char* regional_files[] = {"sangre_de_cristo.tif"};
constexpr const char* geoid_file = "egm96-15.pgm";

bool is_among(const std::filesystem::path& file, const std::vector<std::filesystem::path>& others) {
    std::error_code missing;
    const auto is_same = [&](const std::filesystem::path& other) {
        return std::filesystem::is_regular_file(other, missing) &&
               std::filesystem::file_size(other, missing) == std::filesystem::file_size(file) &&
               planet::sha256_of_file(other) == planet::sha256_of_file(file);
    };
    return std::any_of(others.begin(), others.end(), is_same);
}

}  // namespace

Earth open_earth(const EarthSources& sources) {
    // First what the user named: what is wrong with it shows at once.
    std::vector<std::shared_ptr<const planet::ElevationField>> named;
    for (const auto& file : sources.elevation)
        named.push_back(planet::open_raster_field(file, sources.elevation_datum));
    const auto geoid = std::make_shared<const planet::Geoid>(data_file(geoid_file));
    std::vector<std::shared_ptr<const planet::ElevationField>> layers;
    layers.push_back(planet::make_surface_field(planet::read_raster(data_file(relief_file)),
                                                planet::read_raster(data_file(land_file)), VerticalDatum::egm96));
    for (const char* file : regional_files)
        if (!is_among(data_file(file), sources.covering))
            layers.push_back(planet::open_raster_field(data_file(file), VerticalDatum::egm96));
    layers.insert(layers.end(), named.begin(), named.end());
    auto undulation = [geoid](auto normals, auto out) { geoid->undulations(normals, out); };
    auto heights =
        std::make_shared<planet::LayeredField>(std::move(layers), VerticalDatum::egm96, std::move(undulation));
    return {std::move(heights), geoid};
}

std::string earth_checksum(const EarthSources& sources, ChecksumIndex& index) {
    std::string text;
    const auto add = [&](const std::filesystem::path& file) { text.append(index.sha256(file)).append("\n"); };
    for (const char* file : {relief_file, land_file, geoid_file}) add(data_file(file));
    for (const char* file : regional_files) add(data_file(file));
    for (const auto& file : sources.elevation) add(file);
    if (!sources.elevation.empty()) text.append(planet::name_of(sources.elevation_datum));
    planet::Sha256 sum;
    sum.add(text.data(), text.size());
    return sum.hex();
}

}  // namespace render
