#include "planet/mesh/segment_surface.h"

#include <gtest/gtest.h>

#include <random>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/pick.h"

namespace planet {
namespace {

double hills(const glm::dvec3& n) {
    return 3000 * std::sin(31 * n.x) * std::cos(17 * n.y + n.z);
}

SegmentView view_at(double latitude, double longitude, double height) {
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, normal_from_geodetic(latitude * degrees, longitude * degrees), {height}), 60};
    view.culling.eye = view.test.eye;
    return view;
}

// A place is where a ray along its vertical meets the drawn triangles, which pick() finds by another way.
TEST(SegmentSurface, IsWhereTheVerticalMeetsTheMesh) {
    const testing::BallTiles tiles(24, 0.001, hills);
    std::mt19937_64 dice(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const auto& [latitude, longitude, height] :
         {std::tuple{40.0, -105.0, 2e4}, {90.0, 0.0, 1e4}, {0.0, 180.0, 5e5}}) {
        const SegmentView view = view_at(latitude, longitude, height);
        Segments segments;
        segments.build(tiles, view);
        SegmentSurface surface(segments);
        const glm::dvec3 middle = normal_from_geodetic(latitude * degrees, longitude * degrees);
        for (int i = 0; i < 300; ++i) {
            const double spread = std::exp2(-20 * std::abs(unit(dice)));
            const glm::dvec3 n = glm::normalize(middle + spread * glm::dvec3(unit(dice), unit(dice), unit(dice)));
            const auto point = surface.point_at(n);
            ASSERT_TRUE(point);
            const glm::dvec3 above = ecef_from_normal(wgs84, n, {20e3});
            const auto picked = pick(tiles, view.test, above, -n);
            ASSERT_TRUE(picked);
            // The planes meet on sides; which triangle a place on one belongs to may round either way.
            EXPECT_LT(glm::distance(*point, picked->position), 0.02) << i;
        }
    }
}

TEST(SegmentSurface, KnowsWhereNothingIsDrawn) {
    const testing::BallTiles tiles(14, 0.001, hills);
    SegmentView view = view_at(10, 20, 1e5);
    view.culling.occluder_radius = wgs84.b - 1e4;
    Segments segments;
    segments.build(tiles, view);
    SegmentSurface surface(segments);
    EXPECT_TRUE(surface.point_at(normal_from_geodetic(10 * degrees, 20 * degrees)));
    EXPECT_FALSE(surface.point_at(normal_from_geodetic(-10 * degrees, -160 * degrees)));
    EXPECT_FALSE(SegmentSurface().point_at({0, 0, 1}));
}

}  // namespace
}  // namespace planet
