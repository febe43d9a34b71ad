#pragma once
// Shortest lines on the ellipsoid, through GeographicLib: Karney, "Algorithms for geodesics", Journal of Geodesy 87
// (2013). Both problems are solved everywhere, nearly antipodal points included, to 15 nm on the Earth.
//
// Positions are feet on the ellipsoid: heights play no part. Latitudes lie in [-pi/2, pi/2]; a latitude outside or
// anything not finite gives NaN results. Azimuths are in [-pi, pi], clockwise from north; at a pole "north" is that of
// the meridian of the longitude given.

#include <memory>
#include <span>
#include <vector>

#include "planet/frames.h"
#include "planet/geodesy/ellipsoid.h"

namespace planet {

/// The shortest line between two positions.
struct GeodesicInverse {
    double distance;       ///< metres
    double start_azimuth;  ///< rad: the direction of travel at the start
    double end_azimuth;    ///< rad: the direction of travel, still forward, at the end
};

/// A position on a line and the direction of travel there.
struct GeodesicPoint {
    double latitude;   ///< rad
    double longitude;  ///< rad, [-pi, pi]
    double azimuth;    ///< rad
};

/// A polygon whose sides are geodesics.
struct PolygonSize {
    double area;       ///< square metres, positive when counter-clockwise seen from above
    double perimeter;  ///< metres
};

/// Geodesics on one ellipsoid. Holds the series for its flattening; cheap to copy, safe to use from several threads.
class Geodesics {
  public:
    /// @param e flattening at most 1/50, where the series reach full precision. Throws Error(bad_usage) beyond.
    explicit Geodesics(const Ellipsoid& e = wgs84);

    /// From the first position to the second. If several lines are equally short (antipodes), one of them.
    GeodesicInverse inverse(const Geodetic& from, const Geodetic& to) const;
    double distance(const Geodetic& from, const Geodetic& to) const { return inverse(from, to).distance; }
    /// False if another line is as short to 1 um: near antipodes that mirror each other in the equator or the meridian, and
    /// between the poles. Of places that are none: true.
    bool is_unique(const Geodetic& from, const Geodetic& to) const;

    /// Where a line leads. @param azimuth rad, any finite. @param distance_m any finite; negative goes backwards.
    GeodesicPoint direct(const Geodetic& from, double azimuth, double distance_m) const;

    /// Points along the shortest line, evenly spaced by distance and both ends included (the last one as computed: to
    /// 15 nm the position `to`). @param count at least 2
    std::vector<GeodesicPoint> points_along(const Geodetic& from, const Geodetic& to, std::size_t count) const;

    /// Area and perimeter of the closed polygon over these corners, first not repeated; may hold a pole. Positive area
    /// up to half the ellipsoid's when counter-clockwise, negative when clockwise. Fewer than 3 corners: area 0. To
    /// 0.1 m^2 a corner on the Earth.
    PolygonSize polygon(std::span<const Geodetic> corners) const;

    const Ellipsoid& ellipsoid() const { return ellipsoid_; }

  private:
    struct Series;
    Ellipsoid ellipsoid_;
    std::shared_ptr<const Series> series_;
};

}  // namespace planet
