#include "planet/geodesy/geodetic.h"

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <limits>
#include <vector>

namespace planet {

namespace {

bool is_finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double latitude_degrees(double latitude_rad) {
    constexpr double pole = std::numbers::pi / 2;
    if (!(std::abs(latitude_rad) <= pole)) return nan;
    return std::clamp(latitude_rad / degrees, -90.0, 90.0);
}

glm::dvec3 ecef_from_geodetic(const Ellipsoid& e, const Geodetic& g) {
    const double latitude = latitude_degrees(g.latitude);
    if (std::isnan(latitude) || !std::isfinite(g.longitude) || std::isnan(g.h.m)) return glm::dvec3(nan);
    glm::dvec3 p;
    GeographicLib::Geocentric(e.a, e.f).Forward(latitude, g.longitude / degrees, g.h.m, p.x, p.y, p.z);
    return p;
}

Geodetic geodetic_from_ecef(const Ellipsoid& e, const glm::dvec3& p) {
    if (!is_finite(p)) return {nan, nan, {nan}};
    double latitude = 0, longitude = 0, h = 0;
    GeographicLib::Geocentric(e.a, e.f).Reverse(p.x, p.y, p.z, latitude, longitude, h);
    return {latitude * degrees, longitude * degrees, {h}};
}

NormalPosition position_from_ecef(const Ellipsoid& e, const glm::dvec3& p) {
    if (!is_finite(p)) return {glm::dvec3(nan), {nan}};
    double latitude = 0, longitude = 0, h = 0;
    std::vector<double> ecef_from_enu(9);  // row-major; the third column is up
    GeographicLib::Geocentric(e.a, e.f).Reverse(p.x, p.y, p.z, latitude, longitude, h, ecef_from_enu);
    return {{ecef_from_enu[2], ecef_from_enu[5], ecef_from_enu[8]}, {h}};
}

}  // namespace planet
