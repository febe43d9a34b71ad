#include "planet/geodesy/sun.h"

#include <gtest/gtest.h>

#include <array>

#include "planet/geodesy/earth_rotation.h"

namespace planet {
namespace {

constexpr double arc_second = degrees / 3600;
constexpr double time_second = 15 * arc_second;

double hms(double h, double m, double s) {
    return (h * 3600 + m * 60 + s) * time_second;
}
double dms(double d, double m, double s) {
    return (d * 3600 + m * 60 + s) * arc_second;
}
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}
UtcTime at(const char* text) {
    return utc_from_iso8601(text);
}
/// The instant of UT that belongs to a Terrestrial (Dynamical) Time.
UtcTime from_terrestrial(const char* text) {
    const UtcTime t = at(text);
    return t - std::chrono::milliseconds(static_cast<long>(delta_t(t) * 1000));
}

// Meeus, "Astronomical Algorithms", 2nd ed., examples 12.a and 12.b.
TEST(EarthRotation, SiderealTimeOfMeeus) {
    EXPECT_NEAR(mean_sidereal_time(at("1987-04-10")), hms(13, 10, 46.3668), 1e-4 * time_second);
    EXPECT_NEAR(apparent_sidereal_time(at("1987-04-10")), hms(13, 10, 46.1351), 5e-3 * time_second);
    EXPECT_NEAR(mean_sidereal_time(at("1987-04-10T19:21:00Z")), hms(8, 34, 57.0896), 1e-4 * time_second);
}

// Meeus, example 22.a: 1987 April 10, 0h TD.
TEST(EarthRotation, NutationAndObliquityOfMeeus) {
    const double T = -0.127296372348;
    EXPECT_NEAR(nutation(T).longitude, -3.788 * arc_second, 0.05 * arc_second);
    EXPECT_NEAR(nutation(T).obliquity, 9.443 * arc_second, 0.05 * arc_second);
    EXPECT_NEAR(mean_obliquity(T), dms(23, 26, 27.407), 0.05 * arc_second);
}

// Meeus, example 21.b: theta Persei, J2000 with proper motion applied, to the equinox of 2028 November 13.19 TD.
TEST(EarthRotation, PrecessionOfMeeus) {
    const double T = 0.288670500;
    const glm::dvec3 date =
        mean_of_date_from_j2000(T) * direction_from_equatorial(41.054063 * degrees, 49.227750 * degrees);
    EXPECT_NEAR(std::atan2(date.y, date.x), 41.547214 * degrees, 0.2 * arc_second);
    EXPECT_NEAR(std::asin(date.z), 49.348483 * degrees, 0.1 * arc_second);
}

// Espenak, "Polynomial expressions for Delta T" (NASA) and the Astronomical Almanac's table of observed values.
TEST(EarthRotation, DeltaT) {
    EXPECT_NEAR(delta_t(at("1955-01-01")), 31.1, 1);
    EXPECT_NEAR(delta_t(at("1985-01-01")), 54.3, 1);
    EXPECT_NEAR(delta_t(at("2005-01-01")), 64.7, 1);
    EXPECT_NEAR(delta_t(at("2017-01-01")), 68.6, 1);
    EXPECT_NEAR(delta_t(at("1600-01-01")), 120, 30);
}

/// Apparent place of the sun and orientation of the Earth, computed with ERFA 2.0.0 (the astronomers' library behind
/// the IAU SOFA models): eraEpv00 with light time and eraAb for the sun, eraPnm06a, eraGst06a and eraC2t06a without
/// polar motion, UT1 = UTC, TT from observed delta T. Degrees; the matrix (ITRS from GCRS) by rows.
struct Reference {
    const char* time;
    double right_ascension, declination, sidereal_time;
    std::array<double, 3> sun_ecef;
    std::array<double, 9> ecef_from_gcrs;
};
const Reference references[] = {
    {"1950-01-01T00:00:00Z",
     280.8847652,
     -23.0707406,
     100.0748889,
     {-0.91992983, -0.01300408, -0.39186734},
     {-0.18594226, 0.98256024, -0.00091765, -0.98254863, -0.18594453, -0.00477830, -0.00486560, 0.00001315,
      0.99998816}},
    {"1960-06-08T11:17:00Z",
     76.5760972,
     22.8680524,
     66.0902557,
     {0.90601473, 0.16768834, 0.38861025},
     {0.39717658, 0.91774084, 0.00158861, -0.91773413, 0.39717975, -0.00350904, -0.00385135, -0.00006422, 0.99999258}},
    {"1968-11-15T22:34:00Z",
     231.2523768,
     -18.6874257,
     33.5688467,
     {-0.90252051, -0.28774521, -0.32040511},
     {0.82934153, 0.55873642, 0.00249578, -0.55873377, 0.82934529, -0.00172129, -0.00303161, 0.00003306, 0.99999540}},
    {"1975-04-22T09:51:00Z",
     29.4951040,
     12.0505022,
     357.5868198,
     {0.83018898, 0.51691369, 0.20877378},
     {0.99932526, -0.03665270, 0.00236918, 0.03665253, 0.99932806, 0.00011187, -0.00237169, -0.00002496, 0.99999719}},
    {"1983-09-01T20:08:00Z",
     160.4215418,
     8.2673099,
     282.4183216,
     {-0.52436517, -0.83926464, 0.14379160},
     {0.21868322, -0.97579584, 0.00035978, 0.97579456, 0.21868352, 0.00157820, -0.00161868, 0.00000595, 0.99999869}},
    {"1991-02-08T07:25:00Z",
     321.4492076,
     -15.1217244,
     249.1583005,
     {0.29365150, 0.91962783, -0.26087056},
     {-0.35399600, -0.93524689, -0.00027633, 0.93524656, -0.35399611, 0.00078584, -0.00083277, 0.00001974, 0.99999965}},
    {"1999-07-15T18:42:00Z",
     114.6591359,
     21.5036332,
     213.6728264,
     {-0.14576531, -0.91890482, 0.36656022},
     {-0.83213148, -0.55457839, -0.00007413, 0.55457839, -0.83213149, 0.00000995, -0.00006720, -0.00003283,
      1.00000000}},
    {"2004-12-22T05:59:00Z",
     270.7995406,
     -23.4386388,
     180.8826774,
     {0.00133128, 0.91748563, -0.39776671},
     {-0.99989722, -0.01432969, 0.00046775, 0.01432970, -0.99989732, 0.00002925, 0.00046728, 0.00003595, 0.99999989}},
    {"2008-05-01T16:16:00Z",
     39.2190967,
     15.3306868,
     103.9630142,
     {0.41148229, -0.87222729, 0.26438961},
     {-0.23944909, 0.97090891, 0.00016291, -0.97090857, -0.23944914, 0.00081103, 0.00082644, 0.00003603, 0.99999966}},
    {"2012-10-08T03:33:00Z",
     194.0542934,
     -6.0095595,
     70.4264800,
     {-0.55075240, 0.82807662, -0.10469439},
     {0.33776351, 0.94123092, -0.00040632, -0.94123015, 0.33776375, 0.00120086, 0.00126752, -0.00002317, 0.99999920}},
    {"2016-03-15T14:50:00Z",
     355.8282603,
     -1.8063576,
     36.1375357,
     {0.76218467, -0.64659176, -0.03152167},
     {0.80972847, 0.58680343, -0.00124474, -0.58680265, 0.80972942, 0.00095764, 0.00156985, -0.00004501, 0.99999877}},
    {"2020-08-22T01:07:00Z",
     151.5273615,
     11.6769165,
     347.5550344,
     {-0.94123736, 0.27038752, 0.20239277},
     {0.97551235, -0.21993625, -0.00192557, 0.21993582, 0.97551425, -0.00043515, 0.00197412, 0.00000099, 0.99999805}},
    {"2024-01-01T12:24:00Z",
     281.4913689,
     -23.0177892,
     286.6604973,
     {0.91664038, -0.08292285, -0.39101691},
     {0.28157657, -0.95953856, -0.00062210, 0.95953595, 0.28157726, -0.00223696, 0.00232162, 0.00003295, 0.99999730}},
    {"2026-06-08T23:41:00Z",
     77.1560520,
     22.9128354,
     252.6175295,
     {-0.91820998, -0.07288590, 0.38933030},
     {-0.30441335, -0.95253968, 0.00081467, 0.95253653, -0.30441444, -0.00245020, 0.00258191, 0.00003013, 0.99999667}},
    {"2031-11-15T10:58:00Z",
     230.4728337,
     -18.4855142,
     218.8421219,
     {0.92893058, 0.19120103, -0.31706489},
     {-0.78335541, -0.62156935, 0.00241689, 0.62156623, -0.78335914, -0.00197104, 0.00311843, -0.00004176, 0.99999514}},
    {"2038-04-22T21:15:00Z",
     30.6310568,
     12.4534102,
     169.7782753,
     {-0.73859615, -0.63872739, 0.21564567},
     {-0.98258021, 0.18580358, 0.00362758, -0.18580241, -0.98258691, 0.00066000, 0.00368704, -0.00002551, 0.99999320}},
    {"2044-09-01T08:32:00Z",
     161.1232975,
     7.9832160,
     109.1566562,
     {0.61014922, 0.78001887, 0.13888301},
     {-0.31867075, 0.94786449, 0.00136647, -0.94785548, -0.31867368, 0.00413195, 0.00435199, 0.00002152, 0.99999053}},
    {"2050-02-08T19:49:00Z",
     322.6412902,
     -14.7343155,
     76.3682130,
     {-0.38914603, -0.88536882, -0.25433721},
     {0.24662230, 0.96911098, -0.00115797, -0.96909930, 0.24662502, 0.00475980, 0.00489836, -0.00005169, 0.99998800}},
};

TEST(EarthRotation, AgreesWithErfa) {
    double worst_rotation = 0;
    for (const Reference& r : references) {
        EXPECT_NEAR(std::remainder(apparent_sidereal_time(at(r.time)) - r.sidereal_time * degrees, 360 * degrees), 0,
                    0.3 * arc_second);
        const glm::dmat3 m = ecef_from_j2000(at(r.time));
        for (int column = 0; column < 3; ++column) {
            const auto c = static_cast<std::size_t>(column);
            const glm::dvec3 expected(r.ecef_from_gcrs[c], r.ecef_from_gcrs[c + 3], r.ecef_from_gcrs[c + 6]);
            worst_rotation = std::max(worst_rotation, angle_between(m[column], expected));
        }
    }
    EXPECT_LT(worst_rotation, 0.15 * arc_second);
}

TEST(Sun, AgreesWithErfa) {
    double worst = 0;
    for (const Reference& r : references) {
        const SunPosition sun = sun_position(at(r.time));
        const glm::dvec3 expected(r.sun_ecef[0], r.sun_ecef[1], r.sun_ecef[2]);
        worst = std::max(worst, angle_between(sun.ecef, expected));
        EXPECT_NEAR(sun.right_ascension, r.right_ascension * degrees, 0.001 * degrees) << r.time;
        EXPECT_NEAR(sun.declination, r.declination * degrees, 0.001 * degrees) << r.time;
    }
    EXPECT_LT(worst, 0.0006 * degrees);
}

// Meeus, examples 25.a and 25.b: 1992 October 13, 0h TD. The exact apparent place there: 13h13m30.749s, -7 47'01.74".
TEST(Sun, MeeusOctober1992) {
    const SunPosition sun = sun_position(from_terrestrial("1992-10-13"));
    EXPECT_NEAR(sun.longitude, dms(199, 54, 21.818), 0.001 * degrees);
    EXPECT_NEAR(sun.right_ascension, hms(13, 13, 30.749), 0.001 * degrees);
    EXPECT_NEAR(sun.declination, -dms(7, 47, 1.74), 0.001 * degrees);
    EXPECT_NEAR(sun.distance, 0.99760775 * 149597870700.0, 1e-4 * 149597870700.0);
    EXPECT_NEAR(sun.longitude, 199.90895 * degrees, 0.01 * degrees);  // 25.a, the low accuracy method
}

// Meeus, example 28.a: the equation of time on 1992 October 13, 0h TD is 3.427351 degrees. His mean sun stands at TD,
// ours at UT, a minute earlier: 0.16 s less.
TEST(Sun, EquationOfTimeOfMeeus) {
    const double expected = 3.427351 * degrees - 0.16 * time_second;
    EXPECT_NEAR(equation_of_time(from_terrestrial("1992-10-13")), expected, 0.05 * time_second);
}

// Reda and Andreas, "Solar position algorithm for solar radiation applications" (NREL/TP-560-34302), table A5.1:
// 2003-10-17 12:30:30 at UTC-7. Topocentric parallax is not in alpha and delta of that table's geocentric rows.
TEST(Sun, NrelExample) {
    const SunPosition sun = sun_position(at("2003-10-17T12:30:30-07:00"));
    EXPECT_NEAR(sun.longitude, 204.0085537528 * degrees, 0.001 * degrees);
    EXPECT_NEAR(sun.right_ascension, 202.22741 * degrees, 0.001 * degrees);
    EXPECT_NEAR(sun.declination, -9.31434 * degrees, 0.001 * degrees);
}

// United States Naval Observatory, "Earth's seasons": published to the minute, in which the sun moves 0.0007 degree.
TEST(Sun, PublishedEquinoxesAndSolstices) {
    const std::array<const char*, 12> instants{"2024-03-20T03:06Z", "2024-06-20T20:51Z", "2024-09-22T12:44Z",
                                               "2024-12-21T09:21Z", "2025-03-20T09:01Z", "2025-06-21T02:42Z",
                                               "2025-09-22T18:19Z", "2025-12-21T15:03Z", "2026-03-20T14:46Z",
                                               "2026-06-21T08:25Z", "2026-09-23T00:05Z", "2026-12-21T20:50Z"};
    const double obliquity = 23.4385 * degrees;  // true, 2024 to 2026, to 0.0015 degree
    for (std::size_t i = 0; i < instants.size(); ++i) {
        const SunPosition sun = sun_position(at(instants[i]));
        const int quarter = static_cast<int>(i % 4);
        EXPECT_NEAR(std::remainder(sun.longitude - quarter * 90 * degrees, 360 * degrees), 0, 0.0015 * degrees)
            << instants[i];
        const double declination = quarter == 1 ? obliquity : quarter == 3 ? -obliquity : 0;
        EXPECT_NEAR(sun.declination, declination, 0.0015 * degrees) << instants[i];
    }
}

// The extremes of the equation of time, Meeus chapter 28: about -14 m 15 s in mid February, +3 m 41 s in mid May,
// -6 m 30 s late in July and +16 m 25 s early in November; zero on April 15, June 14, September 1 and December 24/25.
TEST(Sun, EquationOfTimeThroughTheYear) {
    EXPECT_NEAR(equation_of_time(at("2000-02-11T12:00Z")), -hms(0, 14, 15), 3 * time_second);
    EXPECT_NEAR(equation_of_time(at("2000-05-14T12:00Z")), hms(0, 3, 41), 3 * time_second);
    EXPECT_NEAR(equation_of_time(at("2000-07-26T12:00Z")), -hms(0, 6, 32), 4 * time_second);
    EXPECT_NEAR(equation_of_time(at("2000-11-03T12:00Z")), hms(0, 16, 25), 3 * time_second);
    for (const char* zero : {"2000-04-15T12:00Z", "2000-06-13T12:00Z", "2000-09-01T12:00Z", "2000-12-25T12:00Z"})
        EXPECT_NEAR(equation_of_time(at(zero)), 0, 30 * time_second) << zero;
}

TEST(Sun, StandsWhereClocksSay) {
    for (int day = 0; day < 3653; ++day) {
        const UtcTime t = at("2020-01-01T06:00Z") + std::chrono::hours(24 * day);
        const Geodetic g = subsolar_point(t);
        // At 6h UT the mean sun is over 90 E.
        EXPECT_NEAR(g.longitude, 90 * degrees - equation_of_time(t), 1e-9);
        EXPECT_LT(std::abs(g.latitude), 23.45 * degrees);
        EXPECT_NEAR(glm::length(sun_direction(t)), 1, 1e-15);
    }
}

TEST(Sun, MovesSmoothlyOverACentury) {
    UtcTime t = at("1950-01-01T00:00Z");
    glm::dvec3 last = glm::inverse(ecef_from_date(t)) * sun_direction(t);
    for (; t < at("2050-12-31");) {
        t += std::chrono::hours(24);
        const glm::dvec3 next = glm::transpose(ecef_from_date(t)) * sun_direction(t);
        const double moved = angle_between(last, next) / degrees;
        ASSERT_GT(moved, 0.95) << iso8601_from_utc(t);
        ASSERT_LT(moved, 1.025) << iso8601_from_utc(t);
        last = next;
    }
}

}  // namespace
}  // namespace planet
