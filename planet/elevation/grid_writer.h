#pragma once
// Small grids of classes (a viewshed, a mask) as files that geographic information systems read, through GDAL, which is
// in a module of its own (module.h). The bytes are made in memory: how they reach a disk is the caller's business.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace planet {

/// One byte a cell.
struct ClassGrid {
    struct Class {
        std::uint8_t value = 0;
        std::string name;
    };
    int width = 0, height = 0;
    std::span<const std::uint8_t> cells;  ///< row-major from the top left, width * height
    glm::dvec2 top_left{0};               ///< the outer corner of the first cell, in the CRS
    double cell = 0;                      ///< metres: square, columns to the east, rows to the south
    std::string crs;                      ///< a PROJ string or WKT
    std::uint8_t outside = 255;           ///< no value
    std::string description;
    std::vector<Class> classes;  ///< of the other values
};

/// The azimuthal equidistant projection about a place, as a PROJ string: x and y are metres east and north. @param
/// latitude, longitude degrees, on WGS84
std::string azimuthal_equidistant_crs(double latitude, double longitude);

/// A GeoTIFF with its CRS, the value for outside, the description, and the classes in the band's description.
std::string geotiff_of(const ClassGrid& grid);

/// The outline of all cells of one value as GeoJSON polygons (RFC 7946: longitude and latitude of WGS84, cut at the
/// antimeridian), in order of rows; cells that only touch at a corner are apart.
std::string geojson_of(const ClassGrid& grid, std::uint8_t value);

/// What the module implements. All throw Error if GDAL cannot.
class GridDriver {
  public:
    virtual ~GridDriver() = default;
    virtual std::string geotiff(const ClassGrid& grid) const = 0;
    virtual std::string geojson(const ClassGrid& grid, std::uint8_t value) const = 0;
};

}  // namespace planet
