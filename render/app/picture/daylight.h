#pragma once
// When a picture is taken that says no time.

#include "planet/frames.h"
#include "planet/geodesy/utc_time.h"

namespace render {

/// A time when the sun lights a place from the side: 8 h, mean solar time, on the longest day of its hemisphere (21 June
/// or 21 December 2026). Then it stands 23 degrees above the horizon at the poles, 27 at the equator and 30 to 38 from 10
/// to 75 degrees of latitude; the farther the eye, the later, up to 10 h, lest the night come into view. Whole minutes.
/// @param distance_m of the eye from the place: 8 h up to 1000 km, 10 h from 10,000 km on
planet::UtcTime morning_at(const planet::Geodetic& place, double distance_m);

}  // namespace render
