#pragma once
// The shape of a triangle by the squares of its sides: medians, condition (2), angles.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace planet {

/// Squares of the sides ab, bc, ca.
using SquaredSides = std::array<double, 3>;

/// Square of the distance from the corner c to the middle of ab (Apollonius). Of flat triangles most digits cancel.
inline double squared_median(const SquaredSides& s) {
    return (2 * (s[1] + s[2]) - s[0]) / 4;
}

/// Condition (2), |BC| >= |CC'| >= |BC'|, of a triangle whose longest side is ab: whether the longest sides of both halves are
/// sides of the triangle. A right angle at c, where both sides of the last inequality are equal, is one to 9 digits: coordinates
/// of grids are not exact.
inline bool becomes_four(const SquaredSides& s, double median2) {
    constexpr double almost = 1 - 1e-9;
    return std::min(s[1], s[2]) >= median2 && median2 >= s[0] / 4 * almost;
}

/// Smallest angle of a triangle, radians; accurate for the thinnest.
inline double smallest_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 u = b - a, v = c - b, w = a - c;
    const double uu = dot(u, u), vv = dot(v, v), ww = dot(w, w), area = length(cross(u, w));
    if (uu <= vv && uu <= ww) return std::atan2(area, -dot(v, w));
    if (vv <= ww) return std::atan2(area, -dot(w, u));
    return std::atan2(area, -dot(u, v));
}

}  // namespace planet
