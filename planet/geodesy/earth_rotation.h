#pragma once
// How the Earth is turned in space: sidereal time, precession and nutation.
//
// Three frames, all right-handed and centred on the Earth:
//   j2000  mean equator and equinox of J2000: what star catalogues give
//   date   true equator and equinox of the date
//   ecef   turned from `date` by the apparent sidereal time about the z axis
//
// Simplifications, and what they cost: UT1 = UTC (at most 0.9 s, 13.5" in longitude, and what an ISO time can tell),
// no polar motion (0.3"), no frame bias (0.02"), nutation by 13 terms (0.05"). Within 0.15" of the IAU 2006/2000A
// models (ERFA) from 1950 to 2050 at equal UT1 (tested).

#include <glm/glm.hpp>

#include "planet/geodesy/utc_time.h"

namespace planet {

/// TT - UT1 in seconds: how far the uniform time of the ephemerides is ahead of the Earth's rotation. Observed values,
/// by decade, to 2026 (within 1.5 s); to 2100 estimates, which nobody can check yet. Before 1900 and after 2100 the
/// parabola of Morrison and Stephenson, -20 + 32 ((year - 1820) / 100)^2, which does not join them smoothly. A minute
/// moves the sun by 2.5".
double delta_t(UtcTime t);

/// Julian centuries of Terrestrial Time since J2000.
double julian_centuries(UtcTime t);

/// Nutation: how the true equinox and equator of date part from the mean ones, rad.
struct Nutation {
    double longitude;  ///< along the ecliptic, at most 19"
    double obliquity;  ///< at most 10"
};

/// The largest 13 terms of the IAU 1980 theory: Meeus, "Astronomical Algorithms" (2nd ed.), table 22.A.
/// @param T Julian centuries of Terrestrial Time since J2000
Nutation nutation(double T);

/// Angle between ecliptic and mean equator of date, rad: IAU 2006, Capitaine, Wallace and Chapront, A&A 412 (2003),
/// equation 39. Good to a few arc seconds over 10 centuries each way.
double mean_obliquity(double T);

/// Greenwich mean sidereal time, rad in [0, 2 pi): Meeus (12.4), the IAU 1982 expression.
double mean_sidereal_time(UtcTime t);

/// Greenwich apparent sidereal time, rad in [0, 2 pi): the mean one and the nutation in right ascension.
double apparent_sidereal_time(UtcTime t);

/// Precession from the mean equator and equinox of J2000 to those of date: IAU 2006 angles zeta, z, theta, Capitaine et
/// al. (2003), equation 40.
glm::dmat3 mean_of_date_from_j2000(double T);

/// A rotation: an ecef direction from a catalogue's (J2000) one. Without proper motion and aberration of the star
/// (20").
glm::dmat3 ecef_from_j2000(UtcTime t);

/// A rotation: ecef from the true equator and equinox of date.
glm::dmat3 ecef_from_date(UtcTime t);

/// The unit vector of a right ascension and declination, rad.
inline glm::dvec3 direction_from_equatorial(double right_ascension, double declination) {
    const double c = std::cos(declination);
    return {c * std::cos(right_ascension), c * std::sin(right_ascension), std::sin(declination)};
}

}  // namespace planet
