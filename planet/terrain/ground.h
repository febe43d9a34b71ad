#pragma once
// The ground: what every question about heights is answered from, a store's finest surface without the sag of its plane
// cells.
//
//     H  ----------------  interpolated between the corners' heights: the answer          sag = side^2 / 8 R at most:
//        ` - . ____ . - '  the plane of the cell: what is drawn and exported              1.6 m at 9 km, 0.1 mm at 60 m
//
// A plane cell is a chord of the planet, so a level sea would lie below 0 between vertices. The bound of the answer is the
// store's for the plane and the sag beside it: what is drawn, what is written and what is answered agree within it.

#include <limits>

#include "planet/geodesy/ellipsoid.h"
#include "planet/store/store_field.h"

namespace planet {

/// Heights in metres.
struct Ground {
    double height = 0;      ///< above the store's datum
    double undulation = 0;  ///< of the datum above the ellipsoid, linear in the cell; 0 if the store knows none
    double drawn = 0;       ///< above the datum, of the plane of the cell
    /// No source sample of the tile is farther from `height`, along the normal. 0: no source there. Infinite: the tile is
    /// damaged.
    double bound = 0;

    /// How far the plane hangs below, >= 0 but for rounding.
    double sag() const { return height - drawn; }
    EllipsoidalHeight h() const { return {height + undulation}; }
};

/// @param normal unit, finite. Fastest where normals that follow each other are near each other.
inline Ground ground_at(SurfaceCursor& cursor, const glm::dvec3& normal) {
    cursor.seek(normal);
    Ground g;
    g.height = cursor.interpolated_height(normal);
    g.undulation = cursor.undulation(normal);
    g.drawn = cursor.height(normal);
    const auto resampling = static_cast<double>(cursor.tile().resampling);
    if (resampling > 0) g.bound = resampling + std::abs(g.sag());
    return g;
}

/// The place of the ground on the planet, ecef metres.
inline glm::dvec3 ecef_of(const Ellipsoid& e, const glm::dvec3& normal, const Ground& ground) {
    return ecef_from_normal(e, normal, ground.h());
}

}  // namespace planet
