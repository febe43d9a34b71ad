#include "planet/geodesy/geodesic.h"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/GeodesicLine.hpp>
#include <GeographicLib/PolygonArea.hpp>
#include <cassert>
#include <limits>
#include <numbers>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"

namespace planet {

struct Geodesics::Series {
    GeographicLib::Geodesic geodesic;
};

namespace {

constexpr double largest_flattening = 1.0 / 50;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_valid(const Geodetic& g) {
    return std::isfinite(latitude_degrees(g.latitude)) && std::isfinite(g.longitude);
}

GeodesicPoint point_from_degrees(double latitude, double longitude, double azimuth) {
    return {latitude * degrees, longitude * degrees, azimuth * degrees};
}

}  // namespace

Geodesics::Geodesics(const Ellipsoid& e) : ellipsoid_(e) {
    if (!(e.f >= 0 && e.f <= largest_flattening))
        throw Error(Fault::bad_usage, "ellipsoid", "flattening " + std::to_string(e.f), "0 to 0.02");
    series_ = std::make_shared<const Series>(Series{GeographicLib::Geodesic(e.a, e.f)});
}

GeodesicInverse Geodesics::inverse(const Geodetic& from, const Geodetic& to) const {
    if (!is_valid(from) || !is_valid(to)) return {nan, nan, nan};
    double distance = 0, start = 0, end = 0;
    series_->geodesic.Inverse(latitude_degrees(from.latitude), from.longitude / degrees, latitude_degrees(to.latitude),
                              to.longitude / degrees, distance, start, end);
    return {distance, start * degrees, end * degrees};
}

// Karney (2013), section 4: other shortest lines set out at -azimuth, 180 degrees - azimuth, or at any.
bool Geodesics::is_unique(const Geodetic& from, const Geodetic& to) const {
    const GeodesicInverse line = inverse(from, to);
    if (!(line.distance > 0.9 * std::numbers::pi * ellipsoid_.b)) return true;
    for (const double azimuth :
         {-line.start_azimuth, std::numbers::pi - line.start_azimuth, line.start_azimuth + std::numbers::pi / 2}) {
        if (std::abs(std::remainder(azimuth - line.start_azimuth, 2 * std::numbers::pi)) < 1e-9) continue;
        const GeodesicPoint end = direct(from, azimuth, line.distance);
        if (inverse({end.latitude, end.longitude, {}}, to).distance < 1e-6) return false;
    }
    return true;
}

GeodesicPoint Geodesics::direct(const Geodetic& from, double azimuth, double distance_m) const {
    if (!is_valid(from) || !std::isfinite(azimuth) || !std::isfinite(distance_m)) return {nan, nan, nan};
    double latitude = 0, longitude = 0, end = 0;
    series_->geodesic.Direct(latitude_degrees(from.latitude), from.longitude / degrees, azimuth / degrees, distance_m,
                             latitude, longitude, end);
    return point_from_degrees(latitude, longitude, end);
}

std::vector<GeodesicPoint> Geodesics::points_along(const Geodetic& from, const Geodetic& to, std::size_t count) const {
    assert(count >= 2);
    if (!is_valid(from) || !is_valid(to)) return std::vector<GeodesicPoint>(count, {nan, nan, nan});
    const GeographicLib::GeodesicLine line =
        series_->geodesic.InverseLine(latitude_degrees(from.latitude), from.longitude / degrees,
                                      latitude_degrees(to.latitude), to.longitude / degrees);
    std::vector<GeodesicPoint> points;
    points.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double distance = line.Distance() * static_cast<double>(i) / static_cast<double>(count - 1);
        double latitude = 0, longitude = 0, azimuth = 0;
        line.Position(distance, latitude, longitude, azimuth);
        points.push_back(point_from_degrees(latitude, longitude, azimuth));
    }
    return points;
}

PolygonSize Geodesics::polygon(std::span<const Geodetic> corners) const {
    GeographicLib::PolygonArea polygon(series_->geodesic);
    for (const Geodetic& corner : corners) {
        if (!is_valid(corner)) return {nan, nan};
        polygon.AddPoint(latitude_degrees(corner.latitude), corner.longitude / degrees);
    }
    PolygonSize size{0, 0};
    polygon.Compute(false, true, size.perimeter, size.area);
    return size;
}

}  // namespace planet
