// Pictures that say no time show their place by day, and always the same day.

#include "render/app/picture/daylight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/local_frame.h"
#include "planet/geodesy/sun.h"
#include "render/app/fly/flight_plan.h"
#include "tests/render/app/can_draw.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

using planet::degrees;

/// The sun at a place: east, north and up, unit.
glm::dvec3 sun_at(const planet::Geodetic& place, planet::UtcTime time) {
    const glm::dvec3 normal = planet::normal_from_geodetic(place.latitude, place.longitude);
    return glm::transpose(planet::ecef_from_enu(normal)) * planet::sun_direction(time);
}

TEST(Daylight, TheSunStandsInTheEastNeitherLowNorHigh) {
    for (int latitude = -90; latitude <= 90; latitude += 5)
        for (int longitude = -180; longitude <= 180; longitude += 15) {
            const planet::Geodetic place{latitude * degrees, longitude * degrees, {}};
            const glm::dvec3 sun = sun_at(place, morning_at(place, 40e3));
            const double height = std::asin(sun.z) / degrees;
            EXPECT_GT(height, 23) << latitude << ' ' << longitude;
            EXPECT_LT(height, 38) << latitude << ' ' << longitude;
            EXPECT_GT(sun.x, 0.75) << latitude << ' ' << longitude;
        }
}

TEST(Daylight, FromAfarTheSunStandsHigherAndTheChangeIsGradual) {
    const planet::Geodetic place{20 * degrees, -100 * degrees, {}};
    double last = std::asin(sun_at(place, morning_at(place, 1)).z) / degrees;
    for (double distance = 1; distance < 1e9; distance *= 1.1) {
        const double height = std::asin(sun_at(place, morning_at(place, distance)).z) / degrees;
        EXPECT_GE(height, last - 1e-9) << distance;
        EXPECT_LT(height, last + 3) << distance;
        last = height;
    }
    EXPECT_GT(last, 55);
}

TEST(Daylight, TheAntimeridianIsOnePlace) {
    EXPECT_EQ(morning_at({0.2, 180 * degrees, {}}, 1e4), morning_at({0.2, -180 * degrees, {}}, 1e4));
    EXPECT_EQ(planet::iso8601_from_utc(morning_at({0.2, 180 * degrees, {}}, 1e4)), "2026-06-21T20:00:00Z");
    EXPECT_EQ(planet::iso8601_from_utc(morning_at({-0.2, 0, {}}, 1e4)), "2026-12-21T08:00:00Z");
}

/// The time that a picture reports.
std::string time_of(const std::string& arguments) {
    const ScratchFolder folder;
    const Outcome outcome = run(folder.path(), words("render --size 16x9 --json r.json " + arguments));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(content(folder / "r.json"), nullptr, false).value("time", "");
}

TEST(Daylight, OnlyAPlaceWithoutATimeTakesIt) {
    if (!can_draw()) GTEST_SKIP() << "no usable OpenGL";
    EXPECT_EQ(time_of(""), "2026-06-21T09:00:00Z");
    EXPECT_EQ(time_of("--at 37.58,-105.49 --range 40km"), "2026-06-21T15:02:00Z");
    EXPECT_EQ(time_of("--at -90,0 --height 100m"), "2026-12-21T08:00:00Z");
    EXPECT_EQ(time_of("--at 37.58,-105.49"), "2026-06-21T17:02:00Z");
    EXPECT_EQ(time_of("--at 37.58,-105.49 --time 2026-01-01T00:00:00Z"), "2026-01-01T00:00:00Z");
}

TEST(Daylight, AFlightTakesTheMorningOfItsNearestPlaceOrTheFirstTimeItSays) {
    const planet::Geodetic africa{0, 15 * degrees, {}}, alps{46 * degrees, 0, {}};
    FlightPlan plan{.keys = {{.at = africa, .range = 2e7}, {.at = alps, .height = 2e4}, {.at = africa, .range = 3e4}}};
    EXPECT_EQ(planet::iso8601_from_utc(plan.usual_time()), "2026-06-21T08:00:00Z");
    plan.keys[2].time = planet::utc_from_iso8601("2026-01-01T00:00:00Z");
    EXPECT_EQ(plan.usual_time(), plan.keys[2].time);
}

}  // namespace
}  // namespace render
