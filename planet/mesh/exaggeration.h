#pragma once
// What a store's certified numbers become when heights are exaggerated.
//
// Along the normal of a vertex P the plane of a cell lies t(e) above P when heights are multiplied by e. Seen from the
// planet's centre, n = sum l_i n_i the direction of P by those of the corners, all at distances r_i(e) = R + N + e H:
//
//     t(e) = 1 / sum(l_i / r_i(e)) - r_P(e)        concave in e, for it is a harmonic mean of what is linear in e,
//                                                  with |t''| <= 2 variance(H_i) / R
//     t(0) = -sag = -R variance(n_i) / 2           curvature, which is not stretched: at e = 1 it may cancel what the
//                                                  terrain does
//     t(e) = e t(1) + (e - 1) sag - remainder,     0 <= remainder / (e - 1) <= e variance(H_i) / R <= 2 e slope^2 sag
//
// with the slope of the cell's corners (e < 1: the other way around). Bounds by level only, so that both cells of a
// diamond get the same bits and numbers stay saturated.

#include <algorithm>
#include <cmath>

#include "planet/geodesy/ellipsoid.h"
#include "planet/octahedron/cell_metrics.h"

namespace planet {

class Exaggeration {
  public:
    /// @param factor >= 0
    Exaggeration(const Ellipsoid& ellipsoid, double factor)
        : factor_(factor), off_one_(std::fabs(factor - 1)), ellipsoid_(ellipsoid) {}

    /// @param stored deviation of a diamond at factor 1, metres @param bisection_level of its cells
    double deviation(double stored, int bisection_level) const {
        if (off_one_ == 0) return stored;
        const double side = cell_metrics(bisection_level).side_max, slope = steepest(side * ellipsoid_.a);
        return factor_ * stored + off_one_ * sag(side) * std::max(1.0, 2 * factor_ * slope * slope);
    }

    /// The stored radii hold for split vertices rounded to float at factor 1; at another one the roundings differ by up to
    /// 0.9 (1 + e) m a level, which the last term covers. Below 1, lows are not as near the planet's centre and so farther
    /// from each other.
    double radius(double stored_radius, int bisection_level) const {
        if (off_one_ == 0) return stored_radius;
        const double e = std::max(1.0, factor_), wider = factor_ < 1 ? 1 + 0.02 * off_one_ : e;
        return wider * stored_radius + 2 * (1 + e) * (max_bisection_level + 1 - bisection_level);
    }

  private:
    // Of the largest cell: where the circle through its corners is centred in it, with a radius of side / sqrt(3). Cells
    // are nearly right-angled, and for those it is a third too much, which pays for the undulation of the geoid.
    double sag(double side) const {
        return ellipsoid_.a * (ellipsoid_.a / ellipsoid_.b) * (side * side / 3) / (1 + std::sqrt(1 - side * side / 3));
    }
    // Ground between points so far apart: 400 m over 100 m, 4 km over 10 km, 13 km over 100 km.
    static double steepest(double side_m) { return 40 / std::sqrt(std::max(side_m, 100.0)); }

    double factor_, off_one_;
    Ellipsoid ellipsoid_;
};

}  // namespace planet
