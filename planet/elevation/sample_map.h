#pragma once
// Between directions and the columns and rows of a raster, in any CRS.

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/patch_map.h"
#include "planet/elevation/raster.h"

namespace planet {

/// Columns and rows are real numbers, whole at pixel centres. Geographic rasters are mapped in closed form, to 1e-9
/// degrees; others through their CRS, to 1/256 of a sample (patch_map.h). Safe from several threads.
class SampleMap {
  public:
    explicit SampleMap(const RasterHeader& raster);
    SampleMap(const SampleMap&) = delete;
    SampleMap& operator=(const SampleMap&) = delete;

    /// (column, row) of unit geodetic normals. For a raster that goes around, the column is within half a turn of the
    /// raster's middle; else it can lie outside the raster, or be NaN.
    void samples_from_normals(std::span<const glm::dvec3> normals, std::span<glm::dvec2> samples) const;

    /// Unit normals of (column, row), NaN where the CRS has no position. Meant for the raster's own area, half a sample
    /// beyond its outer samples included; a latitude beyond a pole is taken for the pole.
    void normals_from_samples(std::span<const glm::dvec2> samples, std::span<glm::dvec3> normals) const;

    /// The normals of whole columns first_column, ... of a row of the raster: the same bits, and much faster if it is
    /// geographic and upright.
    void normals_of_row(int first_column, int row, std::span<glm::dvec3> normals) const;

    /// For whole columns of rows that follow each other: which part of a row may be in an area. Nothing outside of
    /// [first, last) of what find() gives is in it.
    class RowsInArea {
      public:
        RowsInArea(const SampleMap& map, int first_column, int columns, const SampleArea& area);
        /// Counted from the first column.
        std::pair<int, int> find(int row) const;

      private:
        // Of normals with dot(side, n) >= least.
        struct Bound {
            glm::dvec3 side;
            double least;
            std::size_t first = 0;            // in along_
            double most_along = 0;            // over the columns
            bool rises = true, falls = true;  // from column to column
        };
        std::pair<int, int> find(const Bound& bound, const glm::dvec2& parallel) const;
        void add(const glm::dvec3& side, double least);

        const SampleMap& map_;
        int first_column_, columns_;
        std::array<Bound, 3> bounds_;
        std::size_t bound_count_ = 0;
        std::vector<double> along_;  // by bound and column: the part of the product that the meridian gives
    };

  private:
    void from_longitude_latitude(std::span<const glm::dvec3> normals, std::span<glm::dvec2> samples) const;
    void project_exactly(std::span<const glm::dvec3> normals, std::span<glm::dvec3> samples) const;
    void unproject_exactly(std::span<const glm::dvec2> samples, std::span<glm::dvec3> normals) const;
    void build_patches();

    glm::dvec2 size_;
    SampleGrid grid_;
    std::shared_ptr<const CoordinateTransform> transform_;
    // sample = middle + by_x * (x - x_middle) + by_y * (y - y_middle)
    glm::dvec2 middle_, crs_middle_, by_x_, by_y_;
    std::vector<glm::dvec2> meridians_;  // (cos, sin) of each column's longitude; upright geographic rasters
    std::vector<glm::dvec2> parallels_;  // and of each row's latitude
    // Projected rasters: directions by the faces of a cube around the planet, +x -x +y -y +z -z.
    std::array<std::optional<PatchMap>, 6> from_cube_;
    std::optional<PatchMap> to_normal_;
};

}  // namespace planet
