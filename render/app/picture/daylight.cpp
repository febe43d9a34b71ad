#include "render/app/picture/daylight.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace render {

planet::UtcTime morning_at(const planet::Geodetic& place, double distance_m) {
    using namespace std::chrono;
    constexpr double degrees_per_hour = 15, minutes_per_day = 1440;
    const double afar = std::clamp(std::log10(distance_m / 1e6), 0.0, 1.0);
    const double utc_hour = 8 + 2 * afar - place.longitude / planet::degrees / degrees_per_hour;
    // On that day in UTC wherever it is: the antimeridian is one place, whichever way it is written.
    const double minute = std::round(utc_hour * 60);
    const auto of_day = static_cast<int>(minute - minutes_per_day * std::floor(minute / minutes_per_day));
    const sys_days day = year{2026} / (place.latitude < 0 ? December : June) / 21;
    return day + minutes{of_day};
}

}  // namespace render
