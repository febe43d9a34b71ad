#pragma once
// The reference surface of a planet: an ellipsoid of revolution about the z axis, and the closed forms a vertex needs.
//
// A unit geodetic normal n = (x, y, z) and a height h along it are a position without angles and without iteration:
//
//     p = (a^2 x, a^2 y, b^2 z) / sqrt(a^2 (x^2 + y^2) + b^2 z^2) + h n
//
// The quotient is the only point of the ellipsoid whose outward normal is n (its *foot*). It does not change with the
// length of n, so the rounding of n's length does not move it; it has no singularity, and no case at the poles.
// Latitude and longitude of the position are those of n. See Gade, "A non-singular horizontal position
// representation", Journal of Navigation 63 (2010), equation 22.

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "planet/frames.h"

namespace planet {

/// An oblate ellipsoid of revolution or a sphere, metres. Make one with ellipsoid() or take one of those below.
struct Ellipsoid {
    std::string_view name;  ///< a name of ellipsoid_from_name(), of static storage
    double a = 0;           ///< equatorial semi-axis
    double b = 0;           ///< polar semi-axis, 0 < b <= a
    double f = 0;           ///< flattening (a - b) / a

    /// First eccentricity squared, (a^2 - b^2) / a^2.
    constexpr double e2() const { return f * (2 - f); }
    /// IUGG mean radius R1 = (2 a + b) / 3.
    constexpr double mean_radius() const { return (2 * a + b) / 3; }

    friend constexpr bool operator==(const Ellipsoid& p, const Ellipsoid& q) { return p.a == q.a && p.f == q.f; }
};

/// From the defining constants. @param a metres, > 0. @param f 0 <= f < 1.
/// a - a f rounds once at the size of b, where a (1 - f) would round twice.
constexpr Ellipsoid ellipsoid(std::string_view name, double a, double f) {
    return {name, a, a - a * f, f};
}

/// World Geodetic System 1984: NGA.STND.0036, table 3.1.
inline constexpr Ellipsoid wgs84 = ellipsoid("wgs84", 6378137.0, 1 / 298.257223563);
/// IAU/WGCCRE mean sphere of the Moon, 1737.4 km: Archinal et al., "Report of the IAU Working Group on Cartographic
/// Coordinates and Rotational Elements: 2015", Celestial Mechanics and Dynamical Astronomy 130:22 (2018), table 5.
inline constexpr Ellipsoid moon = ellipsoid("moon", 1737400.0, 0);
/// IAU/WGCCRE ellipsoid of Mars, 3396.19 and 3376.20 km (mean of the two polar radii): the same report, table 4.
inline constexpr Ellipsoid mars = ellipsoid("mars", 3396190.0, (3396190.0 - 3376200.0) / 3396190.0);

/// A sphere; by default one of the Earth's mean radius (2 a + b) / 3 = 6371008.771 m.
constexpr Ellipsoid sphere(double radius = wgs84.mean_radius()) {
    return ellipsoid("sphere", radius, 0);
}

/// "wgs84", "moon", "mars", "sphere", or "sphere:RADIUS" with the radius in metres, 1 to 1e9. Letters of either case.
/// Throws Error(bad_usage) naming the accepted forms.
Ellipsoid ellipsoid_from_name(std::string_view name);

/// A name that ellipsoid_from_name() reads back to the same bits.
std::string to_string(const Ellipsoid& e);

/// The position at height h along a unit geodetic normal, metres. The hot path of every vertex: no branch, one square
/// root, two divisions; the same bits on every machine with IEEE arithmetic as long as products are not contracted.
/// Any h; below the evolute (h < -b^2/a, 6335 km deep on the Earth) normals cross and positions are no longer unique.
/// NaN in any argument gives NaN coordinates. -0 components stay -0.
/// Rounding on WGS84, largest distance to the exact value: 2.5 nm up to 2,000 km, 11 nm at 50,000 km (accuracy.h).
inline glm::dvec3 ecef_from_normal(const Ellipsoid& e, const glm::dvec3& n, EllipsoidalHeight h) {
    const double a2 = e.a * e.a, b2 = e.b * e.b;
    const double w = std::sqrt(a2 * (n.x * n.x + n.y * n.y) + b2 * (n.z * n.z));
    const double equatorial = a2 / w + h.m;
    return {equatorial * n.x, equatorial * n.y, (b2 / w + h.m) * n.z};
}

/// The foot: the point of the ellipsoid whose outward normal is n (any positive length), metres.
inline glm::dvec3 ecef_from_normal(const Ellipsoid& e, const glm::dvec3& n) {
    return ecef_from_normal(e, n, {});
}

/// The outward unit normal at a point of the ellipsoid: the gradient of its equation. Off the surface this is the
/// normal of the concentric, similar ellipsoid through p, *not* the geodetic normal: use normal_from_ecef()
/// (geodetic.h).
inline glm::dvec3 normal_from_surface(const Ellipsoid& e, const glm::dvec3& p) {
    const double a2 = e.a * e.a, b2 = e.b * e.b;
    return glm::normalize(glm::dvec3(p.x / a2, p.y / a2, p.z / b2));
}

/// Radii of curvature of the ellipsoid at a unit normal, metres.
struct CurvatureRadii {
    double meridian;        ///< M, north-south: a (1 - e^2) / (1 - e^2 sin^2 lat)^(3/2)
    double prime_vertical;  ///< N, east-west: a / sqrt(1 - e^2 sin^2 lat), M <= N; equal at the poles

    /// Of the normal section at an azimuth (rad, clockwise from north), Euler's formula.
    double at_azimuth(double azimuth) const {
        const double c = std::cos(azimuth), s = std::sin(azimuth);
        return meridian * prime_vertical / (prime_vertical * c * c + meridian * s * s);
    }
    /// Gaussian mean: the sphere that fits best here.
    double mean() const { return std::sqrt(meridian * prime_vertical); }
};

/// Bowring and Krakiwsky's standard forms, e.g. Rapp, "Geometric Geodesy I" (1991), equations 3.41 and 3.99.
inline CurvatureRadii curvature_radii(const Ellipsoid& e, const glm::dvec3& normal) {
    const double q = 1 - e.e2() * normal.z * normal.z;
    const double N = e.a / std::sqrt(q);
    return {N * (1 - e.e2()) / q, N};
}

}  // namespace planet
