#pragma once
// Plane coordinates on WGS84: UTM between 80 S and 84 N, UPS about the poles, and the MGRS letters over both. Through
// GeographicLib (Karney, "Transverse Mercator with an accuracy of a few nanometers", Journal of Geodesy 85, 2011).

#include <string>
#include <string_view>

#include "planet/frames.h"

namespace planet {

/// A position in UTM or UPS, metres with false easting and northing.
struct Utm {
    int zone = 0;       ///< 1..60 for UTM, 0 for UPS
    bool north = true;  ///< hemisphere
    double easting = 0, northing = 0;
    double convergence = 0;  ///< rad: the bearing of grid north clockwise from true north
    double scale = 1;        ///< of the projection here: grid length over true length
};

/// In the standard zone (Norway and Svalbard have theirs), UPS beyond 84 N and 80 S. At a pole the longitude only turns
/// the convergence. Throws Error(bad_usage) if the latitude is outside [-pi/2, pi/2] or anything is not finite.
Utm utm_from_geodetic(const Geodetic& g);

/// In the zone given, 1..60 or 0 for UPS. Throws Error(bad_usage) if the position is too far outside that zone.
Utm utm_from_geodetic(const Geodetic& g, int zone);

/// Latitude and longitude, h = 0; convergence and scale of `utm` are not read. Throws Error(bad_usage) if zone, easting
/// or northing are out of range.
Geodetic geodetic_from_utm(const Utm& utm);

/// 326zz and 327zz for UTM north and south, 32661 and 32761 for UPS.
int epsg_from_utm_zone(int zone, bool north);

/// "18SUJ2339407396" and the like. @param digits of easting and northing each, 0 (100 km) to 11 (1 um). Throws
/// Error(bad_usage) as utm_from_geodetic(), and for digits out of range.
std::string mgrs_from_geodetic(const Geodetic& g, int digits = 5);

/// The centre of the square that an MGRS text names; spaces are allowed. Throws Error(bad_usage) if it names none.
Geodetic geodetic_from_mgrs(std::string_view text);

}  // namespace planet
