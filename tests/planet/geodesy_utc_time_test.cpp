#include "planet/geodesy/utc_time.h"

#include <gtest/gtest.h>

#include "planet/error.h"

namespace planet {
namespace {

std::string again(const char* text) {
    return iso8601_from_utc(utc_from_iso8601(text));
}

TEST(UtcTime, ReadsTheFormsPeopleWrite) {
    EXPECT_EQ(again("2026-06-21T15:00:00Z"), "2026-06-21T15:00:00Z");
    EXPECT_EQ(again("2026-06-21t15:00:07z"), "2026-06-21T15:00:07Z");
    EXPECT_EQ(again("2026-06-21 15:00Z"), "2026-06-21T15:00:00Z");
    EXPECT_EQ(again("2026-06-21"), "2026-06-21T00:00:00Z");
    EXPECT_EQ(again("2026-06-21T17:00:00+02:00"), "2026-06-21T15:00:00Z");
    EXPECT_EQ(again("2026-01-01T00:30-05:45"), "2026-01-01T06:15:00Z");
    EXPECT_EQ(again("2026-01-01T00:30:00+01:00"), "2025-12-31T23:30:00Z");
    EXPECT_EQ(again("2026-06-21T15:00:00.25Z"), "2026-06-21T15:00:00.250Z");
    EXPECT_EQ(again("2026-06-21T15:00:00,123456789Z"), "2026-06-21T15:00:00.123Z");
    EXPECT_EQ(again("0001-01-01T00:00:00Z"), "0001-01-01T00:00:00Z");
    EXPECT_EQ(again("9999-12-31T23:59:59.999Z"), "9999-12-31T23:59:59.999Z");
    EXPECT_EQ(again("1969-12-31T23:59:59.999Z"), "1969-12-31T23:59:59.999Z");
}

TEST(UtcTime, LeapYearsAndLeapSeconds) {
    EXPECT_EQ(again("2024-02-29"), "2024-02-29T00:00:00Z");
    EXPECT_EQ(again("2000-02-29"), "2000-02-29T00:00:00Z");
    EXPECT_EQ(again("2016-12-31T23:59:60Z"), "2017-01-01T00:00:00Z");
    EXPECT_EQ(again("2017-01-01T00:59:60.5+01:00"), "2017-01-01T00:00:00.500Z");
    EXPECT_THROW(again("1900-02-29"), Error);
    EXPECT_THROW(again("2023-02-29"), Error);
    EXPECT_THROW(again("2016-12-30T23:59:60Z"), Error);
    EXPECT_THROW(again("2016-12-31T22:59:60Z"), Error);
}

TEST(UtcTime, RefusesEverythingElseAndSaysWhatIsAccepted) {
    for (const char* text : {"",
                             " ",
                             "now",
                             "2026",
                             "2026-06",
                             "2026-6-21",
                             "2026-13-01",
                             "2026-00-01",
                             "2026-04-31",
                             "0000-01-01",
                             "2026-06-21T",
                             "2026-06-21T15Z",
                             "2026-06-21T15:00",
                             "2026-06-21T15:00:00",
                             "2026-06-21T24:00:00Z",
                             "2026-06-21T15:60Z",
                             "2026-06-21T15:00:61Z",
                             "2026-06-21T15:00:00.Z",
                             "2026-06-21T15:00:00.1234567890Z",
                             "2026-06-21T15:00:00+2",
                             "2026-06-21T15:00:00+0200",
                             "2026-06-21T15:00:00+24:00",
                             "2026-06-21T15:00:00Zx",
                             " 2026-06-21",
                             "2026-06-21 ",
                             "+2026-06-21",
                             "-2026-06-21",
                             "2026-06-21T-1:00Z",
                             "2026\n06-21"}) {
        try {
            utc_from_iso8601(text, "--time");
            FAIL() << "took \"" << text << '"';
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_usage);
            const std::string what = e.what();
            EXPECT_TRUE(what.starts_with("--time: ")) << what;
            EXPECT_NE(what.find("2026-06-21T15:00:00Z"), std::string::npos) << what;
        }
    }
    const std::string longest(100000, '2');
    EXPECT_THROW(utc_from_iso8601(longest), Error);
    EXPECT_THROW(utc_from_iso8601(std::string("2026-06-21\0", 11)), Error);
}

// Meeus, "Astronomical Algorithms", 2nd ed., chapter 7: example 7.a and the table after it.
TEST(UtcTime, JulianDatesOfMeeus) {
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("1957-10-04T19:26:24Z")), 2436116.31);
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("2000-01-01T12:00Z")), 2451545.0);
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("1999-01-01")), 2451179.5);
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("1987-01-27")), 2446822.5);
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("1988-06-19T12:00Z")), 2447332.0);
    EXPECT_DOUBLE_EQ(julian_date(utc_from_iso8601("1600-12-31")), 2305812.5);
    EXPECT_EQ(days_since_j2000(utc_from_iso8601("2000-01-02T18:00Z")), 1.25);
}

TEST(UtcTime, EveryDayOfTwoCenturiesGoesThereAndBack) {
    const UtcTime end = utc_from_iso8601("2100-01-01");
    for (UtcTime t = utc_from_iso8601("1900-01-01T12:34:56.789Z"); t < end; t += std::chrono::hours(24))
        ASSERT_EQ(utc_from_iso8601(iso8601_from_utc(t)), t);
}

}  // namespace
}  // namespace planet
