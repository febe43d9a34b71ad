// The area of the ground within rings.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ground_stores.h"
#include "planet/terrain/ground_area.h"

namespace planet {
namespace {

using testing::hills;
using testing::level_sea;
using testing::place;

constexpr double wgs84_area = 510065621724088.44;  // Karney, Planimeter

void expect_geodesic_area(const Rings& rings, double expected, const char* what) {
    const GroundArea ground = ground_area(level_sea(), rings);
    EXPECT_NEAR(ground.area, expected, ground.bound + 1e-6 * expected) << what;
    EXPECT_LT(ground.bound, 1e-6 * expected) << what;
}

double geodesic_area(const std::vector<Geodetic>& ring) {
    return std::abs(Geodesics(wgs84).polygon(ring).area);
}

TEST(GroundArea, OfALevelSeaIsKarneysArea) {
    const std::vector<Geodetic> rings[] = {
        {place(37, -109), place(37, -102), place(41, -102), place(41, -109)},
        {place(41, -109), place(41, -102), place(37, -102), place(37, -109)},                 // clockwise
        {place(-3, 178), place(-3, -177), place(4, -178), place(2, 179)},                     // across the antimeridian
        {place(70, 0), place(75, 120), place(72, -110)},                                      // around a pole
        {place(-85, 0), place(-85, 90), place(-85, 180), place(-85, -90)},                    // around the other
        {place(0, 0), place(0, 10), place(10, 10), place(10, 5), place(2, 5), place(10, 0)},  // not convex, E_0
        {place(46, 8), place(46.001, 8), place(46.001, 8.002)}};                              // inside of a cell
    for (const auto& ring : rings) expect_geodesic_area({ring}, geodesic_area(ring), "ring");
}

TEST(GroundArea, EightFacesAreThePlanet) {
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        for (const double pole : {90.0, -90.0}) {
            const GroundArea face =
                ground_area(level_sea(), {{place(0, 90 * i), place(0, 90 * i + 90), place(pole, 0)}});
            EXPECT_NEAR(face.area / (wgs84_area / 8), 1, 1e-6);
            sum += face.area;
        }
    EXPECT_NEAR(sum / wgs84_area, 1, 1e-6);
}

TEST(GroundArea, HolesAndIslandsByParity) {
    const std::vector<Geodetic> outer{place(10, 20), place(10, 30), place(20, 30), place(20, 20)};
    const std::vector<Geodetic> hole{place(13, 23), place(13, 27), place(17, 27), place(17, 23)};
    const std::vector<Geodetic> island{place(14, 24), place(16, 24), place(15, 26)};
    const std::vector<Geodetic> elsewhere{place(-40, 100), place(-41, 104), place(-44, 101)};
    const double expected =
        geodesic_area(outer) - geodesic_area(hole) + geodesic_area(island) + geodesic_area(elsewhere);
    expect_geodesic_area({outer, hole, island, elsewhere}, expected, "in order");
    expect_geodesic_area({island, elsewhere, hole, outer}, expected, "in another");
}

// Four polygons around a point are the one around them.
TEST(GroundArea, AddsUpOverHills) {
    const Geodetic m = testing::hills_middle;
    const auto at = [&](double north, double east) {
        return Geodetic{m.latitude + north * 1e-3, m.longitude + east * 1e-3, {}};
    };
    const std::vector<Geodetic> whole{at(-2, -3), at(-2.2, 3), at(2, 2.7), at(1.9, -3.1)};
    const GroundArea all = ground_area(hills(), {whole});
    double sum = 0, bound = all.bound;
    for (std::size_t i = 0; i < 4; ++i) {
        const GroundArea part = ground_area(hills(), {{m, whole[i], whole[(i + 1) % 4]}});
        sum += part.area;
        bound += part.bound;
    }
    EXPECT_NEAR(sum, all.area, bound + 1e-6 * all.area);
    EXPECT_LT(bound, 1e-5 * all.area);
    EXPECT_GT(all.area, 1.001 * geodesic_area(whole));
    EXPECT_GT(all.cells, 500u);
}

// Against small flat pieces of a square in longitude and latitude.
TEST(GroundArea, AgreesWithSmallPieces) {
    const Geodetic m = testing::hills_middle;
    constexpr int count = 300;
    constexpr double half = 1.5e-3;  // rad: 19 km in all
    std::vector<Geodetic> ring;      // sides of parallels are no geodesics: follow them closely
    for (int side = 0; side < 4; ++side)
        for (int i = 0; i < 60; ++i) {
            const double t = -half + 2 * half * i / 60;
            const double x[4] = {t, half, -t, -half}, y[4] = {-half, t, half, -t};
            ring.push_back({m.latitude + y[side], m.longitude + x[side], {}});
        }
    SurfaceCursor cursor = hills().cursor();
    const auto at = [&](int i, int j) {
        const glm::dvec3 n =
            normal_from_geodetic(m.latitude - half + 2 * half * j / count, m.longitude - half + 2 * half * i / count);
        return ecef_of(wgs84, n, ground_at(cursor, n));
    };
    double sum = 0;
    for (int j = 0; j < count; ++j)
        for (int i = 0; i < count; ++i) {
            const glm::dvec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            sum += 0.5 * glm::length(glm::cross(b - a, d - a)) + 0.5 * glm::length(glm::cross(d - c, b - c));
        }
    const GroundArea area = ground_area(hills(), {ring});
    EXPECT_NEAR(area.area / sum, 1, 5e-4);  // 64 m pieces cut the creases of 700 m cells
    EXPECT_LT(area.bound, 1e-4 * sum);
}

// A shore of many corners.
TEST(GroundArea, ManyCorners) {
    std::vector<Geodetic> ring;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        const double a = 2 * std::numbers::pi * i / count, r = 0.02 * (1 + 0.01 * std::sin(90 * a));
        ring.push_back({0.5 + r * std::sin(a), 1.0 + r * std::cos(a), {}});
    }
    const double expected = geodesic_area(ring);
    const GroundArea area = ground_area(level_sea(), {ring});
    EXPECT_NEAR(area.area, expected, area.bound + 1e-6 * expected);
    EXPECT_LT(area.bound, 1e-4 * expected);
}

TEST(GroundArea, NothingInsideIsNothing) {
    EXPECT_EQ(ground_area(level_sea(), {}).area, 0);
    const std::vector<Geodetic> flat{place(0, 0), place(0, 1), place(0, 0)};
    EXPECT_EQ(ground_area(level_sea(), {flat}).area, 0);
}

}  // namespace
}  // namespace planet
