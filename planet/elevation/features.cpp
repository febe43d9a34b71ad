#include "planet/elevation/features.h"

#include <malloc.h>

#include <cmath>
#include <new>
#include <span>

#include "planet/elevation/module.h"
#include "planet/elevation/source_file.h"
#include "planet/error.h"

namespace planet {
namespace {

const FeatureDriver& driver() {
    using Factory = const FeatureDriver* (*)();
    static const FeatureDriver* const found = reinterpret_cast<Factory>(
        module_symbol("octaglobe_gdal", "octaglobe_gdal_features_2", "reading vector files"))();
    return *found;
}

// Degrees in whole turns that bring the middle of some vertices nearest to a longitude.
double turns_toward(double longitude, std::span<const glm::dvec3> vertices) {
    double west = vertices.front().x, east = west;
    for (const glm::dvec3& v : vertices) west = std::fmin(west, v.x), east = std::fmax(east, v.x);
    return 360 * std::round((longitude - 0.5 * (west + east)) / 360);
}

void turn(std::span<glm::dvec3> vertices, double degrees) {
    for (glm::dvec3& v : vertices) v.x += degrees;
}

void turn_toward(double longitude, Features& features) {
    for (glm::dvec3& point : features.points) turn({&point, 1}, turns_toward(longitude, {&point, 1}));
    for (auto& line : features.lines) turn(line, turns_toward(longitude, line));
    for (Polygon& polygon : features.polygons) {
        const double degrees = turns_toward(longitude, polygon.outer);
        turn(polygon.outer, degrees);
        for (auto& hole : polygon.holes) turn(hole, degrees);
    }
}

}  // namespace

Features read_features(const std::string& path, const FeatureOptions& options) {
    check_source_file(path, "a vector file, e.g. GeoJSON, GeoPackage or Shapefile");
    try {
        Features features = driver().read(path, options);
        // Of a KML or GeoJSON GDAL makes a tree: 1.3 GB of a million points, which would stay with the process.
        ::malloc_trim(0);
        return features;
    } catch (const std::bad_alloc&) {
        throw Error(Fault::bad_data, path, "does not fit into memory");
    }
}

Features read_features(const std::string& path, const Raster& raster, std::int64_t max_vertices) {
    FeatureOptions options;
    options.crs = raster.crs;
    options.plain = raster.plain;
    options.max_vertices = max_vertices;
    Features features = read_features(path, options);
    if (raster.geographic()) {
        const glm::dvec2 middle(0.5 * (raster.width - 1), 0.5 * (raster.height - 1));
        turn_toward(raster.grid.crs_from_sample(middle).x, features);
    }
    return features;
}

}  // namespace planet
