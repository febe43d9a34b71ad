#pragma once
// Between latitude, longitude, height and earth-centred coordinates, through GeographicLib::Geocentric: the reference
// that everything else here is measured against. The vertex path uses ecef_from_normal() of ellipsoid.h instead.

#include <glm/glm.hpp>

#include "planet/frames.h"
#include "planet/geodesy/ellipsoid.h"

namespace planet {

/// A position as a geodetic normal and a height along it: the form without angles.
struct NormalPosition {
    glm::dvec3 normal{0, 0, 1};  ///< unit to 2e-16
    EllipsoidalHeight h{};
};

/// Earth-centred coordinates, metres. Latitude must lie in [-pi/2, pi/2] (the double nearest to pi/2 is the pole);
/// any finite longitude. NaN anywhere, or a latitude outside, gives NaN. At a pole x and y are 0 for every longitude.
/// Radians become degrees for GeographicLib, which rounds once: up to 2 nm at terrain heights.
glm::dvec3 ecef_from_geodetic(const Ellipsoid& e, const Geodetic& g);

/// The nearest foot on the ellipsoid: latitude [-pi/2, pi/2], longitude [-pi, pi] with the sign of y at +-pi, height.
/// On the axis the longitude is 0; at the centre the foot is the north pole; in the disc of the evolute in the
/// equatorial plane, where a northern and a southern foot are equally near, it is the northern one. Not finite: NaN.
/// Going there and back moves a point by less than 10 nm up to 5,000 km from the surface (Karney, GeographicLib).
Geodetic geodetic_from_ecef(const Ellipsoid& e, const glm::dvec3& p);

/// The same, with the normal instead of the angles. Accurate at the poles too, where the longitude is not.
NormalPosition position_from_ecef(const Ellipsoid& e, const glm::dvec3& p);

/// The geodetic normal through a point inside or outside the ellipsoid.
inline glm::dvec3 normal_from_ecef(const Ellipsoid& e, const glm::dvec3& p) {
    return position_from_ecef(e, p).normal;
}

/// The height of a point above the ellipsoid, negative inside.
inline EllipsoidalHeight height_from_ecef(const Ellipsoid& e, const glm::dvec3& p) {
    return position_from_ecef(e, p).h;
}

/// Degrees as GeographicLib takes them. A latitude that rounding carried past 90 is 90; one farther outside is NaN.
double latitude_degrees(double latitude_rad);

}  // namespace planet
