#pragma once
// What the smooth ellipsoid hides: exact tests in the space where it is the unit sphere.

#include <glm/glm.hpp>
#include <optional>

#include "planet/geodesy/ellipsoid.h"

namespace planet {

/// Whether the ellipsoid stands between the eye and a point, both in ecef metres. A point on or above the surface that
/// is seen is never called hidden except by rounding (a few nm); an eye on or inside the surface sees everything (there
/// is no horizon to hide behind). NaN is not hidden. To cull terrain that goes below the ellipsoid, shrink it first:
/// an ellipsoid inside the lowest terrain hides nothing that can be seen.
/// Cozzi and Ring, "3D Engine Design for Virtual Globes" (2011), section 4.4, with the cone test of Ring's "Horizon
/// culling" (2013): p is hidden if it is beyond the plane of the horizon circle and inside the cone of the tangents.
inline bool hidden_by(const Ellipsoid& e, const glm::dvec3& eye, const glm::dvec3& p) {
    const glm::dvec3 scale(1 / e.a, 1 / e.a, 1 / e.b);
    const glm::dvec3 c = eye * scale, d = p * scale - c;
    const double horizon2 = glm::dot(c, c) - 1;  // squared distance to the horizon, scaled
    if (!(horizon2 > 0)) return false;
    const double along = -glm::dot(d, c);
    return along > horizon2 && along * along > horizon2 * glm::dot(d, d);
}

/// Metres along the ray to where it first meets the ellipsoid from outside, or leaves it from inside; nothing if it
/// misses or the surface lies behind. @param direction unit
inline std::optional<double> distance_to_ellipsoid(const Ellipsoid& e, const glm::dvec3& origin,
                                                   const glm::dvec3& direction) {
    const glm::dvec3 scale(1 / e.a, 1 / e.a, 1 / e.b);
    const glm::dvec3 o = origin * scale, d = direction * scale;
    const double dd = glm::dot(d, d), od = glm::dot(o, d);
    // The nearest point of the line to the centre decides hit or miss: b^2 - ac would cancel from far away.
    const glm::dvec3 nearest = o - d * (od / dd);
    const double inside2 = 1 - glm::dot(nearest, nearest);
    if (!(inside2 >= 0)) return std::nullopt;
    const double half = std::sqrt(inside2 / dd), middle = -od / dd;
    if (middle - half >= 0) return middle - half;
    if (middle + half >= 0) return middle + half;
    return std::nullopt;
}

/// Straight-line distance to the horizon from height h above the foot of a unit normal: sqrt(h (2 R + h)), R the
/// Gaussian mean radius there; 0 for h <= 0. On the Earth within 0.2 % of the true one in every direction up to 10 km,
/// and within 0.5 % up to 1,000 km (tested).
inline double horizon_distance(const Ellipsoid& e, const glm::dvec3& normal, EllipsoidalHeight h) {
    if (h.m <= 0) return 0;
    return std::sqrt(h.m * (2 * curvature_radii(e, normal).mean() + h.m));
}

}  // namespace planet
