#pragma once
// Points, lines and polygons of vector files: ridges, rivers, shores, borders, outlines of regions. They are read
// through GDAL, which is in a module of its own (module.h).

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "planet/elevation/raster.h"

namespace planet {

/// Rings are closed: the last vertex repeats the first, so there are at least four. They turn as they do in the file.
struct Polygon {
    std::vector<glm::dvec3> outer;
    std::vector<std::vector<glm::dvec3>> holes;
};

/// What a feature is called, and where: at its point, its longest line's middle vertex, its largest polygon's centroid.
struct FeatureName {
    std::string text;
    glm::dvec2 place{0};  ///< x and y as of a vertex
    bool of_point = false;
};

/// A vertex is (x, y, z): x and y in the CRS that was asked for, z in metres (as the file has it: of no particular
/// vertical datum), NaN where the file has none. x and y are finite.
struct Features {
    std::vector<glm::dvec3> points;
    std::vector<std::vector<glm::dvec3>> lines;  ///< at least two vertices each
    std::vector<Polygon> polygons;
    std::vector<FeatureName>
        names;                      ///< with FeatureOptions::name_field, of features that have one; in the file's order
    std::size_t feature_count = 0;  ///< in the file, those without a place too

    /// Of all of them; the repeated last vertices of rings count.
    std::size_t vertex_count() const {
        std::size_t n = points.size();
        for (const auto& line : lines) n += line.size();
        for (const Polygon& polygon : polygons) {
            n += polygon.outer.size();
            for (const auto& hole : polygon.holes) n += hole.size();
        }
        return n;
    }
};

struct FeatureOptions {
    /// The CRS of x and y, "EPSG:32613" or WKT, x before y. Empty: longitude and latitude of WGS84 in degrees.
    std::string crs;
    /// x and y as they are in the file, whatever CRS it names: for rasters that are `plain`.
    bool plain = false;
    /// The attribute that names features, in any case; empty: none is read. A file without it is refused: Error(bad_usage).
    std::string name_field;
    /// The largest number of vertices kept (24 bytes each). GDAL takes memory of its own, for some formats more.
    std::int64_t max_vertices = 50'000'000;
};

/// Reads the points, lines and polygons of every layer of any vector file that GDAL reads: GeoJSON, GeoPackage,
/// Shapefile, GPX, KML, GML, CSV with a column of WKT or with columns of coordinates (lon, lat, ele; x, y, z; ...).
/// Several in one and collections are taken apart, curves become chords of 4 degrees of arc (within 0.0007 of their
/// radius), the faces of surfaces become polygons. Lines of one vertex count as points, rings without area of fewer
/// than three vertices as lines. In KML and GPX a height of 0 is none unless it is called absolute, and so are heights that
/// KML clamps to the ground or counts from it. A file that names no CRS is taken to be in the one asked for. Longitudes are not
/// turned and lines are not cut at +-180.
///
/// Throws Error(bad_data) if there is no such file, or it is empty, damaged, a raster, has nothing with a place, more
/// than max_vertices, a coordinate that is not finite, a latitude beyond +-90 or a vertex without a place in the CRS;
/// Error(bad_usage) if `crs` is no CRS. Writes no files beside the source.
/// @param path a file or folder, or a name that GDAL knows ("/vsizip/...").
Features read_features(const std::string& path, const FeatureOptions& options = {});

/// The same in the coordinates of a raster's grid: in its CRS, or as they are in the file for a raster that is `plain`.
/// Where the grid is in longitude and latitude, each point, line and polygon is turned by whole turns to where its
/// middle is nearest to the middle of the raster.
Features read_features(const std::string& path, const Raster& raster,
                       std::int64_t max_vertices = FeatureOptions().max_vertices);

/// What the module implements.
class FeatureDriver {
  public:
    virtual ~FeatureDriver() = default;
    virtual Features read(const std::string& path, const FeatureOptions& options) const = 0;
};

}  // namespace planet
