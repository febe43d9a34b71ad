#pragma once
// Instants of Coordinated Universal Time, as people write them (ISO 8601) and as astronomers count them (Julian date).

#include <chrono>
#include <string>
#include <string_view>

namespace planet {

/// An instant in UTC to the millisecond, in days of 86,400 seconds (a leap second coincides with the second after it).
/// The calendar is the Gregorian one at all times, also before 1582.
using UtcTime = std::chrono::sys_time<std::chrono::milliseconds>;

/// Reads ISO 8601 in its extended form, the whole text:
///
///     2026-06-21T15:00:00Z     2026-06-21T15:00:00.250Z     2026-06-21T17:00:00+02:00
///     2026-06-21T15:00Z        2026-06-21                   (midnight UTC)
///
/// Years 0001 to 9999 and days that exist. "T" may be a space or "t", "Z" may be "z"; a time of day needs "Z" or an
/// offset up to 23:59. Of a fraction of a second (1 to 9 digits) whole milliseconds count. 23:59:60 UTC is taken, as
/// the next second, at the end of a June or December, where leap seconds are put. 24:00 is not taken.
/// Throws Error(bad_usage), naming the accepted form.
/// @param where what an Error names as the place, such as "--time"
UtcTime utc_from_iso8601(std::string_view text, std::string_view where = "time");

/// "2026-06-21T15:00:00Z", with ".250" before the Z if there are milliseconds. Years 0 to 9999.
std::string iso8601_from_utc(UtcTime t);

/// Days since -4712-01-01 12:00 (proleptic Julian calendar). A double near 2.5 million resolves 40 microseconds.
double julian_date(UtcTime t);

/// Days since J2000, 2000-01-01 12:00: as julian_date(t) - 2451545, with more digits kept.
double days_since_j2000(UtcTime t);

}  // namespace planet
