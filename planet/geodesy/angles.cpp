#include "planet/geodesy/angles.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace planet {

namespace {

constexpr std::size_t piece = 256;  // points at a time: their arrays stay in the first-level cache

// Four-quadrant arctangent without branches. The rational approximation on [-tan(pi/8), tan(pi/8)] is that of Moshier's
// Cephes library (atan.c, peak relative error 1.8e-16 on [0, 0.66]).
inline double arctangent(double y, double x) {
    const double a = std::abs(y), b = std::abs(x);
    const double small = a < b ? a : b, large = a < b ? b : a;
    const bool second = small > (std::numbers::sqrt2 - 1) * large;  // past 22.5 degrees: measure from 45
    const double over = second ? small - large : small;
    const double under = second ? small + large : large;
    const double t = over / (under > 1e-300 ? under : 1e-300);
    const double z = t * t;
    const double p =
        (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
         1.228866684490136173410e2) *
            z -
        6.485021904942025371773e1;
    const double q =
        ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
         4.853903996359136964868e2) *
            z +
        1.945506571482613964425e2;
    double angle = t + t * (z * p / q) + (second ? std::numbers::pi / 4 : 0.0);
    angle = a > b ? std::numbers::pi / 2 - angle : angle;
    angle = std::copysign(1.0, x) < 0 ? std::numbers::pi - angle : angle;
    return std::copysign(angle + 0 * (a + b), y);  // NaN and infinities give NaN
}

}  // namespace

void angles_from_normals(std::span<const glm::dvec3> normals, std::span<double> longitude, std::span<double> latitude) {
    assert(longitude.size() == normals.size() && latitude.size() == normals.size());
    double x[piece], y[piece], z[piece];
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = normals[first + i].x;
            y[i] = normals[first + i].y;
            z[i] = normals[first + i].z;
        }
        double* const lon = longitude.data() + first;
        double* const lat = latitude.data() + first;
        for (std::size_t i = 0; i < n; ++i) lon[i] = arctangent(y[i], x[i]);
        for (std::size_t i = 0; i < n; ++i) lat[i] = arctangent(z[i], std::sqrt(x[i] * x[i] + y[i] * y[i]));
    }
}

}  // namespace planet
