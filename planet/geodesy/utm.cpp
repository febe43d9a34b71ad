#include "planet/geodesy/utm.h"

#include <GeographicLib/MGRS.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"

namespace planet {
namespace {

using GeographicLib::MGRS;
using GeographicLib::UTMUPS;

/// Runs `f` and turns what GeographicLib throws into an Error of ours.
template <typename F>
auto checked(std::string_view where, std::string_view accepted, F f) {
    try {
        return f();
    } catch (const GeographicLib::GeographicErr& e) {
        throw Error(Fault::bad_usage, where, e.what(), accepted);
    }
}

/// Latitude and longitude in degrees; longitude in [-180, 180].
struct Angles {
    double latitude, longitude;
};
Angles angles_from(const Geodetic& g) {
    const double latitude = latitude_degrees(g.latitude);
    if (std::isnan(latitude))
        throw Error(Fault::bad_usage, "latitude", std::to_string(g.latitude / degrees) + " degrees", "-90 to 90");
    if (!std::isfinite(g.longitude)) throw Error(Fault::bad_usage, "longitude", "not a number", "a finite angle");
    return {latitude, std::remainder(g.longitude / degrees, 360.0)};
}

Utm project(const Geodetic& g, int zone) {
    const Angles angles = angles_from(g);
    Utm utm;
    double convergence = 0;
    UTMUPS::Forward(angles.latitude, angles.longitude, utm.zone, utm.north, utm.easting, utm.northing, convergence,
                    utm.scale, zone);
    utm.convergence = convergence * degrees;
    return utm;
}

void check_zone(int zone) {
    if (zone < UTMUPS::UPS || zone > UTMUPS::MAXUTMZONE)
        throw Error(Fault::bad_usage, "UTM zone", std::to_string(zone), "1 to 60, or 0 for UPS");
}

}  // namespace

Utm utm_from_geodetic(const Geodetic& g) {
    return checked("UTM", "latitude -90 to 90", [&] { return project(g, UTMUPS::STANDARD); });
}

Utm utm_from_geodetic(const Geodetic& g, int zone) {
    check_zone(zone);
    return checked("UTM", "a position near its zone", [&] { return project(g, zone); });
}

Geodetic geodetic_from_utm(const Utm& utm) {
    check_zone(utm.zone);
    if (!std::isfinite(utm.easting) || !std::isfinite(utm.northing))
        throw Error(Fault::bad_usage, "UTM", "easting or northing is not a number", "metres");
    return checked("UTM", "easting and northing inside the zone", [&] {
        double latitude = 0, longitude = 0;
        UTMUPS::Reverse(utm.zone, utm.north, utm.easting, utm.northing, latitude, longitude);
        return Geodetic{latitude * degrees, longitude * degrees, {}};
    });
}

int epsg_from_utm_zone(int zone, bool north) {
    check_zone(zone);
    return UTMUPS::EncodeEPSG(zone, north);
}

std::string mgrs_from_geodetic(const Geodetic& g, int digits) {
    if (digits < 0 || digits > 11) throw Error(Fault::bad_usage, "MGRS digits", std::to_string(digits), "0 to 11");
    return checked("MGRS", "latitude -90 to 90", [&] {
        const Utm utm = project(g, UTMUPS::STANDARD);
        std::string text;
        MGRS::Forward(utm.zone, utm.north, utm.easting, utm.northing, latitude_degrees(g.latitude), digits, text);
        return text;
    });
}

Geodetic geodetic_from_mgrs(std::string_view text) {
    constexpr std::string_view accepted = "a square such as 18SUJ2339407396";
    constexpr std::size_t longest = 64;
    std::string packed;
    for (const char c : text.substr(0, longest))
        if (c != ' ') packed.push_back(c);
    const auto invalid = [&] { return Error(Fault::bad_usage, "MGRS", "\"" + packed + "\" is no square", accepted); };
    if (text.size() > longest) throw invalid();
    return checked("MGRS", accepted, [&] {
        Utm utm;
        int digits = 0;
        MGRS::Reverse(packed, utm.zone, utm.north, utm.easting, utm.northing, digits, true);
        // "INV" is GeographicLib's word for no position, and a bare zone without a square is digits < 0.
        if (utm.zone < UTMUPS::UPS || digits < 0) throw invalid();
        return geodetic_from_utm(utm);
    });
}

}  // namespace planet
