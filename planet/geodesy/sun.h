#pragma once
// Where the sun is, seen from the centre of the Earth, at an instant.
//
// Ecliptic longitude from the largest terms of Bretagnon and Francou's VSOP87D for the Earth (Meeus, "Astronomical
// Algorithms", 2nd ed., chapter 25 "higher accuracy" and appendix III), with nutation and aberration. The sun's
// ecliptic latitude, below 1.2", is taken as 0. Within 0.0006 degree (2") of the IAU 2006/2000A models with ERFA's
// ephemeris from 1950 to 2050 at equal UT1 (tested), and UT1 = UTC adds at most 0.0038 degree in longitude: below 0.005
// degree in all. Some 0.002 degree more per 1000 years before and after.

#include <glm/glm.hpp>

#include "planet/frames.h"
#include "planet/geodesy/utc_time.h"

namespace planet {

/// The sun's apparent geocentric position: where it is seen, nutation and aberration included.
struct SunPosition {
    double longitude;        ///< rad [0, 2 pi), along the ecliptic from the true equinox of date
    double right_ascension;  ///< rad [0, 2 pi), true equator and equinox of date
    double declination;      ///< rad, within +-23.45 degrees
    double distance;         ///< metres, to 1e-4
    glm::dvec3 ecef;         ///< unit direction, earth-centred, earth-fixed
};

SunPosition sun_position(UtcTime t);

/// The unit direction to the sun, earth-centred, earth-fixed. The sun is so far away that it holds for the whole Earth
/// to 0.0025 degree (its parallax, 8.8").
inline glm::dvec3 sun_direction(UtcTime t) {
    return sun_position(t).ecef;
}

/// Where the sun is in the zenith: latitude and longitude of the geodetic normal that points at it.
Geodetic subsolar_point(UtcTime t);

/// Apparent minus mean solar time, rad (a quarter turn is six hours): positive when a sundial is ahead of a clock.
/// Within
/// +-16.5 minutes, +-4.2 degrees.
double equation_of_time(UtcTime t);

}  // namespace planet
