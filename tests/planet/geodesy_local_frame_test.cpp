#include "planet/geodesy/local_frame.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <functional>
#include <limits>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/utm.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Geodetic at(double latitude_deg, double longitude_deg, double h = 0) {
    return {latitude_deg * degrees, longitude_deg * degrees, {h}};
}

double orthonormality(const glm::dmat3& m) {
    const glm::dmat3 p = glm::transpose(m) * m - glm::dmat3(1);
    double worst = std::abs(glm::determinant(m) - 1);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(p[i][j]));
    return worst;
}

TEST(LocalFrame, AgreesWithGeographicLib) {
    for (double lat = -90; lat <= 90; lat += 15)
        for (double lon = -180; lon <= 180; lon += 15) {
            const LocalFrame frame(wgs84, at(lat, lon, 250));
            const GeographicLib::LocalCartesian reference(lat, lon, 250);
            const Geodetic target = at(lat > 0 ? lat - 3 : lat + 3, lon + 2, 9000);
            glm::dvec3 expected;
            reference.Forward(target.latitude / degrees, target.longitude / degrees, 9000, expected.x, expected.y,
                              expected.z);
            EXPECT_LT(glm::distance(frame.enu_from_ecef(ecef_from_geodetic(wgs84, target)), expected), 1e-8);
        }
}

TEST(LocalFrame, IsARotationEverywhereAndTheSameFromNormals) {
    for (double lat = -90; lat <= 90; lat += 7.5)
        for (double lon = -180; lon <= 180; lon += 7.5) {
            const Geodetic g = at(lat, lon);
            const glm::dvec3 n = normal_from_geodetic(g.latitude, g.longitude);
            const glm::dmat3 from_angles = ecef_from_enu(g.latitude, g.longitude), from_normal = ecef_from_enu(n);
            EXPECT_LT(orthonormality(from_angles), 1e-15);
            EXPECT_LT(orthonormality(from_normal), 1e-15);
            EXPECT_LT(glm::distance(from_angles[0], from_normal[0]), 1e-15) << lat << " " << lon;
            EXPECT_LT(glm::distance(from_angles[1], from_normal[1]), 1e-15);
            EXPECT_LT(glm::distance(from_angles[2], from_normal[2]), 1e-15);
        }
}

TEST(LocalFrame, Poles) {
    for (double z : {1.0, -1.0}) {
        const glm::dmat3 m = ecef_from_enu(glm::dvec3(0, 0, z));
        EXPECT_EQ(m[0], glm::dvec3(0, 1, 0));
        EXPECT_EQ(m[1], glm::dvec3(-z, 0, 0));
        EXPECT_EQ(m[2], glm::dvec3(0, 0, z));
        EXPECT_EQ(ecef_from_enu(glm::dvec3(-0.0, -0.0, z)), m);
    }
    const LocalFrame frame(wgs84, at(90, 30));
    EXPECT_LT(glm::distance(frame.ecef_from_enu_rotation()[0], normal_from_geodetic(0, 120 * degrees)), 1e-15);
    EXPECT_EQ(frame.origin(), glm::dvec3(0, 0, wgs84.b));
    EXPECT_TRUE(std::isnan(ecef_from_enu(glm::dvec3(nan, 0, 1))[0].x));
}

TEST(LocalFrame, ThereAndBack) {
    const LocalFrame frame(mars, at(18.65, -133.8, 21229));
    const glm::dvec3 enu(1234.5, -777.25, 3.125), p = frame.ecef_from_enu(enu);
    EXPECT_LT(glm::distance(frame.enu_from_ecef(p), enu), 2e-9);
    EXPECT_LT(glm::distance(glm::dvec3(frame.ecef_from_enu_matrix() * glm::dvec4(enu, 1)), p), 2e-9);
    EXPECT_LT(glm::distance(glm::dvec3(frame.enu_from_ecef_matrix() * glm::dvec4(p, 1)), enu), 4e-9);
    EXPECT_EQ(frame.enu_from_ecef(frame.origin()), glm::dvec3(0));
    const glm::dvec3 n = normal_from_geodetic(0.1, 0.2);
    EXPECT_LT(glm::distance(LocalFrame(wgs84, n, {50}).ecef_from_enu({0, 0, 7}), ecef_from_normal(wgs84, n, {57})),
              2e-9);
}

TEST(LocalFrame, Azimuths) {
    EXPECT_LT(glm::distance(enu_from_azimuth(0, 0), glm::dvec3(0, 1, 0)), 1e-16);
    EXPECT_LT(glm::distance(enu_from_azimuth(90 * degrees, 0), glm::dvec3(1, 0, 0)), 1e-16);
    EXPECT_LT(glm::distance(enu_from_azimuth(1, 90 * degrees), glm::dvec3(0, 0, 1)), 1e-16);
}

// GeographicLib's GeoConvert page: 33.3 N 44.4 E = 38n 444140.54 3684706.36 = 38SMB4414084706.
TEST(Utm, PublishedExample) {
    const Utm utm = utm_from_geodetic(at(33.3, 44.4));
    EXPECT_EQ(utm.zone, 38);
    EXPECT_TRUE(utm.north);
    EXPECT_NEAR(utm.easting, 444140.54, 0.005);
    EXPECT_NEAR(utm.northing, 3684706.36, 0.005);
    EXPECT_EQ(mgrs_from_geodetic(at(33.3, 44.4)), "38SMB4414084706");
    EXPECT_EQ(mgrs_from_geodetic(at(33.3, 44.4), 2), "38SMB4484");
    EXPECT_EQ(epsg_from_utm_zone(38, true), 32638);
    EXPECT_EQ(epsg_from_utm_zone(0, false), 32761);
}

TEST(Utm, ThereAndBackOverThePlanet) {
    for (double lat = -90; lat <= 90; lat += 2.5)
        for (double lon = -180; lon <= 180; lon += 4.5) {
            const Geodetic g = at(lat, lon);
            const Utm utm = utm_from_geodetic(g);
            EXPECT_EQ(utm.zone == 0, lat >= 84 || lat < -80) << lat;
            EXPECT_NEAR(utm.scale, 1, lat >= 84 || lat < -80 ? 0.0075 : 0.0011);
            const glm::dvec3 p = ecef_from_geodetic(wgs84, g);
            EXPECT_LT(glm::distance(ecef_from_geodetic(wgs84, geodetic_from_utm(utm)), p), 2e-8);
            const Geodetic square = geodetic_from_mgrs(mgrs_from_geodetic(g, 5));
            EXPECT_LT(glm::distance(ecef_from_geodetic(wgs84, square), p), 0.75) << lat << " " << lon;
        }
}

TEST(Utm, ZonesOfNorwayAndANeighbour) {
    EXPECT_EQ(utm_from_geodetic(at(60, 4)).zone, 32);
    EXPECT_EQ(utm_from_geodetic(at(78, 10)).zone, 33);
    EXPECT_EQ(utm_from_geodetic(at(10, 180)).zone, 1);
    EXPECT_EQ(utm_from_geodetic(at(10, -180)).zone, 1);
    EXPECT_EQ(utm_from_geodetic(at(10, 540)).zone, 1);
    EXPECT_EQ(utm_from_geodetic(at(60, 4), 31).zone, 31);
    EXPECT_NEAR(utm_from_geodetic(at(45, 9)).convergence, 0, 1e-15);
    EXPECT_GT(utm_from_geodetic(at(45, 10)).convergence, 0);
}

TEST(Utm, BadInputIsOneError) {
    Utm outside;
    outside.zone = 31;
    outside.easting = 5e6;
    Utm no_number = outside;
    no_number.easting = nan;
    Utm no_zone;
    no_zone.zone = 61;
    const std::function<void()> attempts[] = {
        [] { utm_from_geodetic(at(90.001, 0)); }, [] { utm_from_geodetic(at(nan, 0)); },
        [] { utm_from_geodetic(at(0, nan)); },    [] { utm_from_geodetic(at(0, 0), 61); },
        [] { utm_from_geodetic(at(0, 0), -4); },  [] { utm_from_geodetic(at(0, 100), 1); },
        [&] { geodetic_from_utm(outside); },      [&] { geodetic_from_utm(no_number); },
        [&] { geodetic_from_utm(no_zone); },      [] { epsg_from_utm_zone(61, true); },
        [] { mgrs_from_geodetic(at(1, 1), 12); }, [] { mgrs_from_geodetic(at(1, 1), -1); },
        [] { geodetic_from_mgrs(""); },           [] { geodetic_from_mgrs("INV"); },
        [] { geodetic_from_mgrs("38S"); },        [] { geodetic_from_mgrs("38SMB441408470"); },
        [] { geodetic_from_mgrs("99ZZZ"); },      [] { geodetic_from_mgrs(std::string(1000, '3')); }};
    for (std::size_t i = 0; i < std::size(attempts); ++i) {
        try {
            attempts[i]();
            FAIL() << "attempt " << i << " was taken";
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_usage) << i;
        }
    }
    EXPECT_NEAR(geodetic_from_mgrs("38S MB 44140 84706").latitude / degrees, 33.3, 1e-5);
}

}  // namespace
}  // namespace planet
