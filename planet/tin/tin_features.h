#pragma once
// Points and lines that have to be in a TIN, before any greedy insertion: peaks, ridges, rivers, shores.

#include <vector>

#include "planet/elevation/features.h"
#include "planet/elevation/raster.h"
#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"

namespace planet {

/// At samples: (column, row).
struct TinFeatures {
    std::vector<glm::ivec2> points;
    std::vector<std::vector<glm::ivec2>> lines;  ///< at least two vertices each
    std::size_t outside = 0;                     ///< points, and parts of lines, that the raster does not reach

    bool empty() const { return points.empty() && lines.empty(); }
};

/// Every sample so many columns and rows on.
TinFeatures moved(TinFeatures features, glm::ivec2 by);

/// Every vertex at the sample nearest to it. Lines are cut at the border of the raster; the outlines of polygons are
/// lines.
/// @param features in the coordinates of the raster's grid @param raster whose samples are not looked at
TinFeatures features_at_samples(const Features& features, const Raster& raster);

/// What became of them.
struct FeatureReport {
    std::size_t points = 0;      ///< vertices of the TIN that are points
    std::size_t line_sides = 0;  ///< straight parts of lines
    std::size_t duplicates = 0;  ///< points that were there already
    std::size_t over_voids = 0;  ///< points at void samples, left out
    std::size_t around_voids =
        0;  ///< straight parts that meet a void: laid from sample to sample where there are valid ones
    std::size_t crossings = 0;  ///< of lines: both go through the sample nearest to the crossing
    std::size_t dropped = 0;    ///< parts of lines for which no way was found

    FeatureReport& operator+=(const FeatureReport& other);
};

/// Points become vertices, lines constrained sides. @param mesh of the whole grid, with void_border() as vertices
FeatureReport insert_features(Delaunay& mesh, const HeightGrid& grid, const TinFeatures& features);

/// Makes void all samples in no polygon (even-odd: in an outer ring and in none of its holes, or on one).
/// @param polygons in the coordinates of the raster's grid
/// Throws Error(bad_data) if nothing is left.
void keep_within(HeightGrid& grid, const Raster& raster, const std::vector<Polygon>& polygons);

/// The same for a window of the raster, of which nothing need be left. Windows agree about the samples that they share.
/// @param first sample of the raster that is the window's first
void keep_window_within(HeightGrid& window, glm::ivec2 first, const Raster& raster,
                        const std::vector<Polygon>& polygons);

}  // namespace planet
