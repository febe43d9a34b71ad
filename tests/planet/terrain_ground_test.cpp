// Heights of the ground, and the ground under paths.

#include <gtest/gtest.h>

#include <cmath>

#include "ground_stores.h"
#include "planet/error.h"
#include "planet/geodesy/geodesic_path.h"
#include "planet/terrain/ground_path.h"
#include "planet/terrain/ground_walk.h"

namespace planet {
namespace {

using testing::hills;
using testing::level_sea;
using testing::normal_of;
using testing::place;

TEST(Ground, ALevelSeaIsAtZeroThoughItsCellsSag) {
    SurfaceCursor cursor = level_sea().cursor();
    testing::PlacesInHills places;
    double deepest = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 n = normal_of({std::asin(2 * places.unit() - 1), 6.28 * places.unit(), {}});
        const Ground g = ground_at(cursor, n);
        ASSERT_NEAR(g.height, 0, 1e-9);
        ASSERT_LE(g.drawn, 1e-6);
        ASSERT_EQ(g.bound, 0);  // no source there
        deepest = std::min(deepest, g.drawn);
    }
    EXPECT_LT(deepest, -500);  // the planes of 176 km
}

TEST(Ground, IsTheDrawnPlaneAtCornersAndAboveItByTheSagBetween) {
    testing::PlacesInHills places;
    SurfaceCursor cursor = hills().cursor();
    for (int i = 0; i < 500; ++i) {
        cursor.seek(normal_of(places.next()));
        const LocationCode cell = cursor.cell();
        const Corners c = corners(cell);
        const double side = wgs84.a * std::max({glm::length(c.left - c.right), glm::length(c.right - c.apex),
                                                glm::length(c.apex - c.left)});
        const glm::dvec3 middle = glm::normalize(c.left + c.right + c.apex);
        const Ground g = ground_at(cursor, middle);
        ASSERT_EQ(cursor.cell(), cell);
        ASSERT_GT(g.sag(), 0);
        ASSERT_LT(g.sag(), side * side / (6 * wgs84.b) + 1e-6);
        for (const glm::dvec3& corner : {c.left, c.right, c.apex}) {
            const Ground at = ground_at(cursor, corner);
            ASSERT_NEAR(at.height, at.drawn, 1e-6);
        }
    }
}

TEST(Ground, HasNoStepAtSides) {
    testing::PlacesInHills places;
    SurfaceCursor cursor = hills().cursor();
    for (int i = 0; i < 500; ++i) {
        cursor.seek(normal_of(places.next()));
        const Corners c = corners(cursor.cell());
        const double t = places.unit();
        const glm::dvec3 on = glm::normalize(t * c.left + (1 - t) * c.right), across = glm::cross(c.left, c.right);
        const double a = ground_at(cursor, glm::normalize(on + 1e-12 * glm::normalize(across))).height,
                     b = ground_at(cursor, glm::normalize(on - 1e-12 * glm::normalize(across))).height;
        ASSERT_NEAR(a, b, 1e-4);
    }
}

// What is answered, with its bound, holds every sample that the store was made of.
TEST(Ground, BoundHoldsTheSamples) {
    SurfaceCursor cursor = hills().cursor();
    double worst = 0;
    for (const glm::dvec3& n : testing::HillField::scattered()) {
        const Ground g = ground_at(cursor, n);
        const double off = std::abs(testing::HillField::exact(n) - g.height);
        ASSERT_GT(g.bound, 0);
        ASSERT_LE(off, g.bound + 1e-3);  // samples are floats
        worst = std::max(worst, off / g.bound);
    }
    EXPECT_GT(worst, 0.3);  // and is not merely large
}

struct CountingVisitor {
    bool enter(const Corners&) { return ++open, true; }
    void leave() { --open; }
    bool halve(const GroundCell& cell) const {
        return wgs84.a * glm::length(cell.normal.left - cell.normal.right) > longest;
    }
    void visit(const GroundCell& cell) {
        ++cells;
        const double turn = glm::dot(cell.normal.left, glm::cross(cell.normal.right, cell.normal.apex));
        wrong += (turn > 0) != cell.counter_clockwise;
        solid_angle += std::abs(turn) /
                       (1 + glm::dot(cell.normal.left, cell.normal.right) +
                        glm::dot(cell.normal.right, cell.normal.apex) + glm::dot(cell.normal.apex, cell.normal.left)) *
                       2;
    }
    double longest;
    int open = 0;
    std::size_t cells = 0, wrong = 0;
    double solid_angle = 0;  // small cells: tan is its argument
};

TEST(GroundWalk, CoversThePlanetOnce) {
    CountingVisitor visitor{50000};
    GroundWalk(hills().cache(), visitor).planet();
    EXPECT_EQ(visitor.open, 0);
    EXPECT_EQ(visitor.wrong, 0u);
    EXPECT_GT(visitor.cells, 8u << 12);
    EXPECT_NEAR(visitor.solid_angle, 4 * std::numbers::pi, 1e-4);
}

TEST(GeodesicPath, GoesThroughItsPlaces) {
    const Geodesics lines;
    const std::vector<Geodetic> places{place(50, 8), place(51, 9), place(51, 9), place(-10, 179), place(-12, -179)};
    const GeodesicPath path(lines, places);
    ASSERT_EQ(path.legs(), 4u);
    double sum = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_NEAR(path.leg_start(i), sum, 1e-6);
        const GeodesicPoint p = path.at(path.leg_start(i));
        EXPECT_LT(lines.distance({p.latitude, p.longitude, {}}, places[i]), 1e-6) << i;
        if (i + 1 < places.size()) sum += lines.distance(places[i], places[i + 1]);
    }
    EXPECT_NEAR(path.length(), sum, 1e-6);
    EXPECT_LT(lines.distance(places.back(), {path.at(1e9).latitude, path.at(1e9).longitude, {}}), 1e-6);
    EXPECT_LT(lines.distance(places.front(), {path.at(-5).latitude, path.at(-5).longitude, {}}), 1e-6);
    EXPECT_THROW(GeodesicPath(lines, std::vector{place(91, 0), place(0, 0)}), Error);
    EXPECT_THROW(GeodesicPath(lines, std::vector{place(NAN, 0), place(0, 0)}), Error);
}

TEST(PathTotals, OverALevelSeaIsTheGeodesic) {
    const Geodesics lines;
    for (const auto& ends :
         {std::array{place(46, 8), place(47, 9)}, std::array{place(0, 0), place(0.5, 179.7)},
          std::array{place(85, 10), place(86, -160)}, std::array{place(-16, 179.9), place(-16, -179.9)}}) {
        const GeodesicPath path(lines, ends);
        const PathTotals totals = measure_path(level_sea(), path);
        EXPECT_NEAR(totals.length / path.length(), 1, 1e-6);
        EXPECT_NEAR(totals.ascent, 0, 1e-6);
        EXPECT_EQ(totals.bound, 0);
    }
}

// Against steps so short that what they cut off does not matter.
TEST(PathTotals, AgreeWithShortSteps) {
    const Geodesics lines;
    testing::PlacesInHills places;
    for (int i = 0; i < 4; ++i) {
        const std::array ends{places.next(), places.next()};
        const GeodesicPath path(lines, ends);
        const PathTotals totals = measure_path(hills(), path);
        const std::vector<PathSample> samples =
            sample_path(hills(), path, static_cast<std::size_t>(path.length() / 0.5) + 2);
        double length = 0, ascent = 0, highest = -1e9;
        glm::dvec3 before{};
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const PathSample& s = samples[k];
            const glm::dvec3 at = ecef_of(wgs84, normal_from_geodetic(s.place.latitude, s.place.longitude), s.ground);
            if (k > 0) {
                length += glm::length(at - before);
                ascent += std::max(s.ground.height - samples[k - 1].ground.height, 0.0);
            }
            highest = std::max(highest, s.ground.height);
            before = at;
        }
        EXPECT_NEAR(totals.length / length, 1, 3e-6);
        EXPECT_GT(totals.length, length - 1e-3);
        EXPECT_GT(totals.length, path.length() + 1);
        EXPECT_NEAR(totals.ascent, ascent, 1e-3 * ascent);
        EXPECT_NEAR(totals.highest, highest, 1);
        EXPECT_GE(totals.highest, highest - 1e-6);
        EXPECT_NEAR(totals.ascent - totals.descent, samples.back().ground.height - samples.front().ground.height, 1e-6);
        EXPECT_GT(totals.bound, 0);
        // The way back is as long.
        const std::array back{ends[1], ends[0]};
        const PathTotals returned = measure_path(hills(), GeodesicPath(lines, back));
        EXPECT_NEAR(returned.length, totals.length, 1e-6 * totals.length);
        EXPECT_NEAR(returned.ascent, totals.descent, 0.01);
    }
}

}  // namespace
}  // namespace planet
