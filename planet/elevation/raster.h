#pragma once
// A grid of heights, as its file holds it: compact, georeferenced, with its samples at pixel centres.

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace planet {

/// Coordinates of a reference system (CRS) from longitude and latitude, and back. Safe from several threads.
class CoordinateTransform {
  public:
    virtual ~CoordinateTransform() = default;
    /// In place: (longitude, latitude) in degrees to (x, y) in units of the CRS; NaN where there is none.
    virtual void crs_from_geodetic(std::span<glm::dvec2> points) const = 0;
    /// In place, the other way; longitudes in [-180, 180].
    virtual void geodetic_from_crs(std::span<glm::dvec2> points) const = 0;
};

/// Where samples lie: crs = origin + column * per_column + row * per_row, at the *centre* of a pixel whatever the file
/// says of areas and points. A pixel reaches half a column and half a row to every side.
struct SampleGrid {
    glm::dvec2 origin{0};      ///< of sample (0, 0)
    glm::dvec2 per_column{0};  ///< degrees if geographic, else units of the CRS
    glm::dvec2 per_row{0};

    glm::dvec2 crs_from_sample(glm::dvec2 column_row) const {
        return origin + column_row.x * per_column + column_row.y * per_row;
    }
    double determinant() const { return per_column.x * per_row.y - per_column.y * per_row.x; }
};

// Marks among the samples. Float storage: NaN is void, -infinity is water.
inline constexpr std::int16_t void_sample = -32768;   ///< no height known
inline constexpr std::int16_t water_sample = -32767;  ///< open water: height 0, flat (see surface_field.h)

/// What a raster is, without its samples. Metres = offset + scale * sample.
struct RasterHeader {
    int width = 0, height = 0;  ///< at least 1 each
    double scale = 1, offset = 0;

    SampleGrid grid;
    std::string crs;  ///< "EPSG:4326", or WKT; of the horizontal part
    /// What the file says that its heights are measured from: "EPSG:5773" or a name, "ellipsoid", or empty.
    std::string vertical_crs;
    /// Null if the grid is in (longitude, latitude) degrees of the planet itself, or plain; else how to get there.
    std::shared_ptr<const CoordinateTransform> transform;
    double radius_m = 6378137;  ///< semi-major axis of the CRS's ellipsoid
    /// The grid is no known place on a planet: crs is empty and transform null. Such a raster is a surface of its own,
    /// not one for a SampleMap or a RasterField. Only where RasterOptions::plain allows it.
    bool plain = false;

    std::string name;      ///< file name without its folder
    std::string checksum;  ///< SHA-256, 64 hex digits
    int reduction = 1;     ///< only every n-th row and column of the file was kept

    bool geographic() const { return !transform && !plain; }
    std::size_t count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// A grid of heights, all in memory.
struct Raster : RasterHeader {
    /// Row-major in the order of the file, width * height of them. 16-bit where the source fits, so that a large DEM
    /// takes two bytes a sample.
    std::variant<std::vector<std::int16_t>, std::vector<float>> samples;

    /// A height in metres; NaN where void. Column and row within the grid.
    double at(int column, int row) const {
        const auto i =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
        if (const auto* s = std::get_if<std::vector<std::int16_t>>(&samples)) {
            if ((*s)[i] == water_sample) return 0;
            return (*s)[i] == void_sample ? std::numeric_limits<double>::quiet_NaN() : offset + scale * (*s)[i];
        }
        const float f = std::get<std::vector<float>>(samples)[i];
        return std::isinf(f) ? 0 : offset + scale * static_cast<double>(f);
    }
};

/// Columns in a full turn of longitude if the raster goes all the way around, else 0. A last column that repeats the
/// first one is allowed.
int columns_around(const RasterHeader& raster);

/// Where a geographic, upright raster ends at a pole. `first` is the end at row 0, `last` that at row height-1.
enum class PoleRow {
    none,     ///< it does not reach a pole there
    at_edge,  ///< the pole is the outer edge of the last row's pixels
    at_row,   ///< the pole is the last row itself
};
struct Poles {
    PoleRow first = PoleRow::none, last = PoleRow::none;
};
/// Only rasters with an even number of columns_around continue across a pole; for others both are none.
Poles poles_of(const RasterHeader& raster);

}  // namespace planet
