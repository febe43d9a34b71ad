#pragma once
// READ FIRST: every coordinate system of the project, its range, handedness and unit.
//
//  name          type             range and unit                        what it is
//  ------------  ---------------  ------------------------------------  ------------------------------------------------
//  geodetic      Geodetic         latitude [-pi/2, pi/2] rad,           latitude is the angle of the ellipsoid's normal,
//                                 longitude [-pi, pi] rad, h in m       h the distance along it
//  normal        glm::dvec3       unit vector                           the geodetic normal (the "n-vector"): the same
//                                                                       direction as (latitude, longitude), no singularity
//  ecef          glm::dvec3       m, right-handed                       earth-centred, earth-fixed: x through latitude 0
//                                                                       longitude 0, y through longitude 90 E, z north
//  enu           glm::dvec3       m, right-handed                       local frame: x east, y north, z up
//  grid          GridPosition     42 bits an axis, 2^-18 m              ecef on a planet-fixed integer grid (mesh/grid.h);
//                                                                       a vertex has the same bits wherever it is drawn
//  code          LocationCode     64 bits                               a cell of the octahedron (octahedron/location_code.h)
//  view          glm::vec3        m, right-handed, -z ahead             the eye at the origin, x right, y up
//  clip          glm::vec4        reversed depth: near 1, far 0         what OpenGL takes; glClipControl(LOWER_LEFT, ZERO_TO_ONE)
//  picture       pixels           x right, y down, origin top left      parts of 2048 x 2048 on a grid fixed at the top left
//
// Angles are radians inside, degrees at the command line and in files. Lengths are metres. Matrices and conversions are
// named x_from_y: ecef_from_geodetic, view_from_ecef, clip_from_view.
//
// Three heights, never mixed:
//   h  ellipsoidal height: above the ellipsoid, along its normal           EllipsoidalHeight
//   H  orthometric height: above the geoid ("above sea level")             OrthometricHeight
//   N  geoid undulation: the geoid above the ellipsoid                     GeoidUndulation
//   h = H + N, and adding the geoid is always written out.

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace planet {

struct GeoidUndulation {
    double m = 0;  ///< metres
};
struct EllipsoidalHeight {
    double m = 0;  ///< metres
};
struct OrthometricHeight {
    double m = 0;  ///< metres
};

constexpr EllipsoidalHeight operator+(OrthometricHeight H, GeoidUndulation N) {
    return {H.m + N.m};
}
constexpr OrthometricHeight operator-(EllipsoidalHeight h, GeoidUndulation N) {
    return {h.m - N.m};
}
constexpr GeoidUndulation operator-(EllipsoidalHeight h, OrthometricHeight H) {
    return {h.m - H.m};
}

/// A position by latitude, longitude and ellipsoidal height.
struct Geodetic {
    double latitude = 0;   ///< rad, [-pi/2, pi/2]
    double longitude = 0;  ///< rad, [-pi, pi]
    EllipsoidalHeight h{};
};

constexpr double degrees = std::numbers::pi / 180.0;  ///< radians in a degree: 45 * degrees

/// The geodetic normal of a latitude and longitude in radians. At a pole every longitude gives the pole to 1e-16.
inline glm::dvec3 normal_from_geodetic(double latitude, double longitude) {
    const double c = std::cos(latitude);
    return {c * std::cos(longitude), c * std::sin(longitude), std::sin(latitude)};
}

/// Latitude and longitude of a geodetic normal (any positive length). At a pole the longitude is 0 if x = y = 0.
inline Geodetic geodetic_from_normal(const glm::dvec3& n) {
    return {std::atan2(n.z, std::hypot(n.x, n.y)), std::atan2(n.y, n.x), {}};
}

}  // namespace planet
