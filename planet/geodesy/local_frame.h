#pragma once
// A local frame: x east, y north, z up (along the geodetic normal), with its origin at a position. Metres.

#include <glm/glm.hpp>

#include "planet/frames.h"
#include "planet/geodesy/ellipsoid.h"

namespace planet {

/// Columns east, north, up in ecef: a rotation, orthonormal to rounding. Every longitude has its own east at a pole: at
/// the north pole "north" points along the meridian of longitude + pi, as it does just south of the pole.
inline glm::dmat3 ecef_from_enu(double latitude, double longitude) {
    const double cl = std::cos(longitude), sl = std::sin(longitude);
    const double cp = std::cos(latitude), sp = std::sin(latitude);
    return {{-sl, cl, 0}, {-cl * sp, -sl * sp, cp}, {cl * cp, sl * cp, sp}};
}

/// The same at a unit geodetic normal, without angles: up is the normal itself. Where x = y = 0, a pole, the longitude
/// is taken as 0 and east as +y. -0 counts as 0. NaN gives NaN.
inline glm::dmat3 ecef_from_enu(const glm::dvec3& normal) {
    const double c = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    const glm::dvec3 east = c > 0 || std::isnan(c) ? glm::dvec3(-normal.y / c, normal.x / c, 0) : glm::dvec3(0, 1, 0);
    return {east, glm::cross(normal, east), normal};
}

/// A local frame with its origin.
class LocalFrame {
  public:
    /// At latitude, longitude and height; latitude as in ecef_from_geodetic(). At a pole the longitude says where east
    /// is.
    LocalFrame(const Ellipsoid& e, const Geodetic& origin);
    /// At a unit geodetic normal and a height.
    LocalFrame(const Ellipsoid& e, const glm::dvec3& normal, EllipsoidalHeight h)
        : origin_(ecef_from_normal(e, normal, h)), axes_(planet::ecef_from_enu(normal)) {}

    /// The origin in ecef, metres.
    const glm::dvec3& origin() const { return origin_; }
    /// Rotation only: for directions.
    const glm::dmat3& ecef_from_enu_rotation() const { return axes_; }

    glm::dvec3 ecef_from_enu(const glm::dvec3& enu) const { return origin_ + axes_ * enu; }
    /// Subtracts the origin first: near it no digits are lost, as they are in a 4x4 matrix product.
    glm::dvec3 enu_from_ecef(const glm::dvec3& ecef) const { return glm::transpose(axes_) * (ecef - origin_); }

    /// Homogeneous matrices for scene graphs. enu_from_ecef_matrix() cancels: 1e-9 m.
    glm::dmat4 ecef_from_enu_matrix() const;
    glm::dmat4 enu_from_ecef_matrix() const;

  private:
    glm::dvec3 origin_;
    glm::dmat3 axes_;
};

/// The direction of an azimuth (rad, clockwise from north) and an elevation angle (rad above the horizontal) in enu.
inline glm::dvec3 enu_from_azimuth(double azimuth, double elevation_angle) {
    const double c = std::cos(elevation_angle);
    return {c * std::sin(azimuth), c * std::cos(azimuth), std::sin(elevation_angle)};
}

}  // namespace planet
