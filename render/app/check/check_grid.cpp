#include <algorithm>
#include <cmath>
#include <random>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/grid.h"
#include "render/app/check/check_parts.h"

namespace render {
namespace {

struct Worst {
    double rounding = 0;   // m, of one coordinate
    double unstable = 0;   // positions that have other bits after going off the grid and on again
    double positions = 0;  // checked
};

void measure(const glm::dvec3& p, Worst& worst) {
    const planet::GridPosition grid = planet::grid_from_ecef(p);
    const glm::dvec3 back = planet::ecef_from_grid(grid);
    // Both are multiples of p's last place and less than a step apart: the difference is exact.
    for (int axis = 0; axis < 3; ++axis)
        if (const double off = std::abs(back[axis] - p[axis]); !(off <= worst.rounding)) worst.rounding = off;
    if (!(planet::grid_from_ecef(back) == grid)) ++worst.unstable;
    ++worst.positions;
}

}  // namespace

CheckPart check_grid() {
    constexpr int random_points = 1 << 20;
    constexpr double lowest = -11e3, highest = 2000e3;  // m above the ellipsoid
    std::mt19937_64 engine(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    };
    Worst worst;
    for (const double latitude : {-90., -45., -0., 0., 45., 90.})
        for (int eighth = -4; eighth <= 4; ++eighth)
            for (const double h : {lowest, 0., highest})
                measure(
                    planet::ecef_from_normal(
                        planet::wgs84,
                        planet::normal_from_geodetic(latitude * planet::degrees, eighth * 45 * planet::degrees), {h}),
                    worst);
    for (int i = 0; i < random_points; ++i) {
        const double z = between(-1, 1), longitude = between(-std::numbers::pi, std::numbers::pi);
        const glm::dvec3 normal = planet::normal_from_geodetic(std::asin(z), longitude);
        measure(planet::ecef_from_normal(planet::wgs84, normal, {between(lowest, highest)}), worst);
    }
    return {{planet::check_row("grid positions checked", worst.positions, worst.positions, "1"),
             planet::check_row("grid coordinate from the exact one", worst.rounding, planet::grid_rounding_m, "m"),
             planet::check_row("grid positions that change on the way back", worst.unstable, 0, "1")},
            {}};
}

}  // namespace render
