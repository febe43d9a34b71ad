#include "planet/geodesy/ellipsoid.h"

#include <gtest/gtest.h>

#include <GeographicLib/Ellipsoid.hpp>
#include <bit>
#include <limits>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/horizon.h"
#include "planet/geodesy/local_frame.h"

namespace planet {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Calls f(latitude, longitude) in radians over the planet, poles and antimeridian included.
template <typename F>
void over_the_planet(double step_degrees, F f) {
    for (double lat = -90; lat <= 90; lat += step_degrees)
        for (double lon = -180; lon <= 180; lon += step_degrees) f(lat * degrees, lon * degrees);
}

TEST(Ellipsoid, PublishedConstants) {
    EXPECT_EQ(wgs84.a, 6378137.0);
    EXPECT_NEAR(wgs84.b, 6356752.314245179497564, 5e-10);  // NGA.STND.0036
    EXPECT_NEAR(wgs84.e2(), 6.69437999014e-3, 1e-14);      // the same
    EXPECT_NEAR(wgs84.mean_radius(), 6371008.7714, 1e-4);  // the same, R1
    EXPECT_EQ(moon.a, 1737400.0);
    EXPECT_EQ(moon.b, moon.a);
    EXPECT_NEAR(mars.b, 3376200.0, 1e-9);
    EXPECT_NEAR(1 / mars.f, 169.8944, 1e-4);
    EXPECT_EQ(sphere(5.0).b, 5.0);
}

TEST(Ellipsoid, NamesGoThereAndBack) {
    for (const Ellipsoid& e : {wgs84, moon, mars, sphere(), sphere(1), sphere(6371000.1), sphere(1e9)})
        EXPECT_EQ(ellipsoid_from_name(to_string(e)), e) << to_string(e);
    EXPECT_EQ(ellipsoid_from_name("WGS84"), wgs84);
    EXPECT_EQ(ellipsoid_from_name("Sphere:6371000").a, 6371000);
    for (const char* bad : {"", "earth", "wgs84 ", "sphere:", "sphere:0", "sphere:-1", "sphere:nan", "sphere:inf",
                            "sphere:1e10", "sphere:6371000m", "sphere6371000"}) {
        try {
            ellipsoid_from_name(bad);
            FAIL() << bad;
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_usage);
            EXPECT_NE(std::string(e.what()).find("wgs84"), std::string::npos);
        }
    }
}

TEST(Ellipsoid, FootLiesOnTheSurfaceAndHasTheNormal) {
    for (const Ellipsoid& e : {wgs84, moon, mars, sphere()})
        over_the_planet(7.5, [&e](double latitude, double longitude) {
            const glm::dvec3 n = normal_from_geodetic(latitude, longitude), p = ecef_from_normal(e, n);
            EXPECT_NEAR((p.x * p.x + p.y * p.y) / (e.a * e.a) + p.z * p.z / (e.b * e.b), 1, 1e-15);
            EXPECT_LT(glm::distance(normal_from_surface(e, p), n), 4e-16);
        });
}

TEST(Ellipsoid, FootDoesNotDependOnTheLengthOfTheNormal) {
    over_the_planet(15, [](double latitude, double longitude) {
        const glm::dvec3 n = normal_from_geodetic(latitude, longitude);
        EXPECT_EQ(ecef_from_normal(wgs84, n * 4.0), ecef_from_normal(wgs84, n));
        EXPECT_LT(glm::distance(ecef_from_normal(wgs84, n * 1.000001), ecef_from_normal(wgs84, n)), 3e-9);
    });
}

TEST(Ellipsoid, PositionsAreEqualAcrossTheAxesBitForBit) {
    const glm::dvec3 n = normal_from_geodetic(0.7, 0.3), p = ecef_from_normal(wgs84, n, {1234.5});
    EXPECT_EQ(ecef_from_normal(wgs84, {-n.x, n.y, -n.z}, {1234.5}), glm::dvec3(-p.x, p.y, -p.z));
    EXPECT_EQ(ecef_from_normal(wgs84, {n.y, n.x, n.z}, {1234.5}), glm::dvec3(p.y, p.x, p.z));
}

// The bits of these positions are part of every stored and drawn vertex: they must not change with compiler or machine.
TEST(Ellipsoid, PositionsHaveKnownBits) {
    const glm::dvec3 n(0.6, -0.48, 0.64), p = ecef_from_normal(wgs84, n, {4372.25});
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.x), 0x414d41c586fdf92du);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.y), 0xc14767d138cb2dbeu);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.z), 0x414effa4efa70c70u);
}

TEST(Ellipsoid, Poles) {
    EXPECT_EQ(ecef_from_normal(wgs84, {0, 0, 1}, {10}), glm::dvec3(0, 0, wgs84.b + 10));
    EXPECT_EQ(ecef_from_normal(wgs84, {0, 0, -1}), glm::dvec3(0, 0, -wgs84.b));
    EXPECT_EQ(ecef_from_normal(wgs84, {-1, 0, 0}, {-10}), glm::dvec3(-wgs84.a + 10, 0, 0));
    EXPECT_TRUE(std::signbit(ecef_from_normal(wgs84, {1, -0.0, -0.0}).y));
}

TEST(Ellipsoid, NaNInNaNOut) {
    EXPECT_TRUE(std::isnan(ecef_from_normal(wgs84, {nan, 0, 1}).x));
    EXPECT_TRUE(std::isnan(ecef_from_normal(wgs84, {0, 0, 1}, {nan}).z));
    EXPECT_TRUE(std::isnan(ecef_from_normal(wgs84, {0, 0, 0}).z));
}

TEST(Ellipsoid, CurvatureRadiiAgreeWithGeographicLib) {
    const GeographicLib::Ellipsoid reference(wgs84.a, wgs84.f);
    for (double lat = -90; lat <= 90; lat += 1.25) {
        const CurvatureRadii r = curvature_radii(wgs84, normal_from_geodetic(lat * degrees, 1));
        EXPECT_NEAR(r.meridian, reference.MeridionalCurvatureRadius(lat), 1e-8);
        EXPECT_NEAR(r.prime_vertical, reference.TransverseCurvatureRadius(lat), 1e-8);
        for (double azimuth : {0.0, 33.0, 90.0, 170.0, -60.0})
            EXPECT_NEAR(r.at_azimuth(azimuth * degrees), reference.NormalCurvatureRadius(lat, azimuth), 1e-8);
        EXPECT_GE(r.mean(), r.meridian - 1e-8);
        EXPECT_LE(r.mean(), r.prime_vertical + 1e-8);
    }
}

TEST(Geodetic, ThereAndBack) {
    for (const Ellipsoid& e : {wgs84, moon, mars, sphere()})
        for (double h : {-11e3, -0.0, 8848.0, 400e3, 5000e3})
            over_the_planet(15, [&](double latitude, double longitude) {
                const glm::dvec3 p = ecef_from_geodetic(e, {latitude, longitude, {h}});
                const Geodetic g = geodetic_from_ecef(e, p);
                EXPECT_NEAR(g.latitude, latitude, 4e-15);
                EXPECT_NEAR(g.h.m, h, 1e-8);
                EXPECT_LT(glm::distance(ecef_from_geodetic(e, g), p), 1e-8);
                const NormalPosition back = position_from_ecef(e, p);
                EXPECT_LT(glm::distance(back.normal, normal_from_geodetic(latitude, longitude)), 1e-15);
                EXPECT_NEAR(back.h.m, h, 1e-8);
            });
}

TEST(Geodetic, ClosedFormAgrees) {
    over_the_planet(5, [](double latitude, double longitude) {
        const glm::dvec3 p = ecef_from_normal(wgs84, normal_from_geodetic(latitude, longitude), {5000});
        EXPECT_LT(glm::distance(ecef_from_geodetic(wgs84, {latitude, longitude, {5000}}), p), 1e-8);
    });
}

TEST(Geodetic, Poles) {
    constexpr double pole = 90 * degrees;
    for (double longitude : {-180 * degrees, -1.0, -0.0, 0.0, 2.5, 180 * degrees}) {
        EXPECT_EQ(ecef_from_geodetic(wgs84, {pole, longitude, {3}}), glm::dvec3(0, 0, wgs84.b + 3));
        EXPECT_EQ(ecef_from_geodetic(wgs84, {-pole, longitude, {}}), glm::dvec3(0, 0, -wgs84.b));
    }
    const Geodetic north = geodetic_from_ecef(wgs84, {0, 0, wgs84.b + 3});
    EXPECT_EQ(north.latitude, pole);
    EXPECT_EQ(north.longitude, 0);
    EXPECT_NEAR(north.h.m, 3, 1e-9);
    EXPECT_EQ(normal_from_ecef(wgs84, {0, 0, -7e6}), glm::dvec3(0, 0, -1));
    // A micrometre beside the pole the normal is still right to 2e-16, and knows its side.
    const glm::dvec3 beside = normal_from_ecef(wgs84, {1e-6, -2e-6, wgs84.b});
    const double to_normal = wgs84.b / (wgs84.a * wgs84.a);
    EXPECT_NEAR(beside.x, 1e-6 * to_normal, 1e-25);
    EXPECT_NEAR(beside.y, -2e-6 * to_normal, 1e-25);
}

TEST(Geodetic, Antimeridian) {
    EXPECT_EQ(geodetic_from_ecef(wgs84, {-7e6, 0.0, 1e6}).longitude, 180 * degrees);
    EXPECT_EQ(geodetic_from_ecef(wgs84, {-7e6, -0.0, 1e6}).longitude, -180 * degrees);
    EXPECT_EQ(ecef_from_geodetic(wgs84, {0.5, 180 * degrees, {}}).y, 0);
    EXPECT_EQ(ecef_from_geodetic(wgs84, {0.5, -180 * degrees, {}}),
              ecef_from_geodetic(wgs84, {0.5, 180 * degrees, {}}));
    EXPECT_LT(glm::distance(ecef_from_geodetic(wgs84, {0.5, 190 * degrees, {}}),
                            ecef_from_geodetic(wgs84, {0.5, -170 * degrees, {}})),
              1e-8);
}

TEST(Geodetic, InsideThePlanet) {
    EXPECT_EQ(normal_from_ecef(wgs84, {0, 0, 0}), glm::dvec3(0, 0, 1));
    EXPECT_NEAR(height_from_ecef(wgs84, {0, 0, 0}).m, -wgs84.b, 1e-9);
    const Geodetic deep = geodetic_from_ecef(wgs84, ecef_from_geodetic(wgs84, {0.6, 1.1, {-3000e3}}));
    EXPECT_NEAR(deep.latitude, 0.6, 1e-14);
    EXPECT_NEAR(deep.h.m, -3000e3, 1e-8);
}

TEST(Geodetic, NoPositionIsNaN) {
    EXPECT_TRUE(std::isnan(ecef_from_geodetic(wgs84, {nan, 0, {}}).x));
    EXPECT_TRUE(std::isnan(ecef_from_geodetic(wgs84, {0, infinity, {}}).x));
    EXPECT_TRUE(std::isnan(ecef_from_geodetic(wgs84, {0, 0, {nan}}).x));
    EXPECT_TRUE(std::isnan(ecef_from_geodetic(wgs84, {91 * degrees, 0, {}}).x));
    EXPECT_TRUE(std::isnan(geodetic_from_ecef(wgs84, {nan, 0, 0}).latitude));
    EXPECT_TRUE(std::isnan(normal_from_ecef(wgs84, {infinity, 0, 0}).x));
}

TEST(Horizon, HidesWhatARayWouldMeet) {
    int hidden = 0, seen = 0;
    for (const Ellipsoid& e : {wgs84, mars, moon})
        for (double height : {1.7, 5e3, 400e3, 36000e3})
            over_the_planet(10, [&](double latitude, double longitude) {
                const glm::dvec3 eye = ecef_from_normal(e, normal_from_geodetic(0.6, -1.2), {height});
                const glm::dvec3 p = ecef_from_normal(e, normal_from_geodetic(latitude, longitude), {3000});
                const double range = glm::distance(eye, p);
                const auto hit = distance_to_ellipsoid(e, eye, (p - eye) / range);
                const bool blocked = hit && *hit < range;
                EXPECT_EQ(hidden_by(e, eye, p), blocked) << latitude << " " << longitude << " " << height;
                ++(blocked ? hidden : seen);
            });
    EXPECT_GT(hidden, 1000);
    EXPECT_GT(seen, 100);
}

TEST(Horizon, RaysMeetTheSurface) {
    const glm::dvec3 eye(5e7, 1e7, -2e7);
    over_the_planet(10, [&eye](double latitude, double longitude) {
        const glm::dvec3 p = ecef_from_normal(wgs84, normal_from_geodetic(latitude, longitude)) * 0.9;
        const glm::dvec3 direction = glm::normalize(p - eye);
        const auto hit = distance_to_ellipsoid(wgs84, eye, direction);
        ASSERT_TRUE(hit);
        EXPECT_LT(std::abs(height_from_ecef(wgs84, eye + direction * *hit).m), 1e-6);
        EXPECT_LT(*hit, glm::distance(eye, p));
    });
    EXPECT_FALSE(distance_to_ellipsoid(wgs84, eye, glm::normalize(eye)));
    EXPECT_FALSE(distance_to_ellipsoid(wgs84, eye, {0, 1, 0}));
    EXPECT_NEAR(*distance_to_ellipsoid(wgs84, {0, 0, 0}, {0, 0, 1}), wgs84.b, 1e-8);
    EXPECT_FALSE(distance_to_ellipsoid(wgs84, {nan, 0, 0}, {0, 0, 1}));
    EXPECT_FALSE(hidden_by(wgs84, {0, 0, 1e6}, {0, 0, -7e6}));
}

/// The length of the ray from the eye that only just touches the ellipsoid, by halving the angle below the horizontal.
double touching_ray(const Ellipsoid& e, const glm::dvec3& eye, const glm::dvec3& up, const glm::dvec3& ahead) {
    double misses = 0, meets = std::numbers::pi / 2, length = 0;
    for (int i = 0; i < 45; ++i) {
        const double dip = (misses + meets) / 2;
        const auto hit = distance_to_ellipsoid(e, eye, ahead * std::cos(dip) - up * std::sin(dip));
        (hit ? meets : misses) = dip;
        if (hit) length = *hit;
    }
    return length;
}

TEST(Horizon, DistanceOfTheHorizonAgreesWithTouchingRays) {
    for (double lat = -90; lat <= 90; lat += 15)
        for (double azimuth = 0; azimuth < 360; azimuth += 30)
            for (double h : {100.0, 10e3, 1000e3}) {
                const glm::dmat3 enu = ecef_from_enu(lat * degrees, 0.3);
                const glm::dvec3 eye = ecef_from_normal(wgs84, enu[2], {h});
                const glm::dvec3 ahead = enu * enu_from_azimuth(azimuth * degrees, 0);
                const double expected = touching_ray(wgs84, eye, enu[2], ahead);
                EXPECT_NEAR(horizon_distance(wgs84, enu[2], {h}) / expected, 1, h > 10e3 ? 0.005 : 0.002) << lat;
            }
    EXPECT_NEAR(horizon_distance(sphere(6371000), {0, 0, 1}, {1.7}), 4654.2, 0.1);
    EXPECT_EQ(horizon_distance(wgs84, {0, 0, 1}, {-5}), 0);
}

}  // namespace
}  // namespace planet
