#pragma once
// What is seen from a place: for every cell of a grid around it whether its middle is, by the same test as a single line
// of sight (sight.h) against every cell of the ground on the way: "R3" of Franklin and Ray, "Higher isn't necessarily
// better: visibility algorithms and experiments" (1994), without its interpolation.
//
// What makes it fast: the plane around the eye is cut into sectors as narrow as a grid cell at the rim, each with the
// ground cells that reach into it, the nearest first. Blocks of these know how steep a line may at most be that touches
// them, and nearly all are passed over by one comparison.

#include <cstdint>
#include <functional>
#include <vector>

#include "planet/terrain/sight.h"

namespace planet {

struct ViewshedOptions : SightOptions {
    double radius = 20000;  ///< metres along the ellipsoid, 10..viewshed_radius_max_m
    double cell = 0;        ///< metres; 0: radius / 400
    unsigned threads = 0;   ///< 0: one for each processor
    /// Told the share that is done, from any thread.
    std::function<void(double)> progress;
};

inline constexpr double viewshed_radius_max_m = 500000;
inline constexpr int viewshed_side_max = 8191;  ///< cells
/// Cells of the ground within the radius, 40 bytes each.
inline constexpr std::size_t viewshed_ground_max = 24'000'000;

/// A grid in the azimuthal equidistant projection about the eye: column 0 is in the west, row 0 in the north, the eye in
/// the middle of the middle cell.
struct Viewshed {
    enum : std::uint8_t { hidden = 0, visible = 1, outside = 255 };

    int side = 0;                     ///< columns and rows, odd
    double cell = 0;                  ///< metres
    std::vector<std::uint8_t> cells;  ///< row-major
    std::vector<float> heights;       ///< row-major: of the ground above the ellipsoid, metres; NaN outside
    std::size_t visible_count = 0, count = 0;
    std::size_t ground_cells = 0;
    double bound = 0;  ///< the largest of the ground, metres

    std::uint8_t at(int column, int row) const {
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(column)];
    }
    /// The middle of a cell in the projection: metres east and north of the eye.
    glm::dvec2 middle(int column, int row) const { return glm::dvec2(column - side / 2, side / 2 - row) * cell; }
    double visible_area = 0;  ///< square metres on the ellipsoid
    double visible_share() const { return static_cast<double>(visible_count) / static_cast<double>(count); }
    std::size_t side_count() const { return static_cast<std::size_t>(side); }
};

/// Throws Error(bad_usage) for an option out of range, or where there are too many ground cells within the radius.
Viewshed viewshed(const StoreField& field, const Geodetic& eye, const ViewshedOptions& options);

}  // namespace planet
