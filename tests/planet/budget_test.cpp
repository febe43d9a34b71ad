#include "planet/mesh/budget.h"

#include <gtest/gtest.h>

#include "ball_tiles.h"
#include "planet/error.h"
#include "planet/frames.h"
#include "planet/mesh/segments.h"

namespace planet {
namespace {

using testing::BallTiles;

double hills(const glm::dvec3& n) {
    return 3000 * std::sin(31 * n.x) * std::cos(17 * n.y + n.z);
}

SegmentView view_ahead(double height) {
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, normal_from_geodetic(0.3, -2), {height}), 2000};
    view.culling.eye = view.test.eye;
    view.culling.occluder_radius = 6.3e6;
    const glm::dvec3 down = -glm::normalize(view.test.eye), right = glm::normalize(glm::cross(down, {0, 0, 1}));
    view.culling.inward[0] = glm::normalize(right + down);
    view.culling.inward[1] = glm::normalize(-right + down);
    return view;
}

std::size_t triangles_at(const TileSource& tiles, SegmentView view, double K) {
    view.test.K = K;
    Segments segments;
    segments.build(tiles, view);
    return segments.leaf_count();
}

TEST(Budget, CountsWhatIsDrawn) {
    const BallTiles tiles(24, 0.002, hills);
    for (const double height : {2e4, 1e6, 2e7}) {
        SegmentView view = view_ahead(height);
        for (const double K : {0.0, 20.0, 100.0, 300.0}) {
            view.test.K = K;
            const std::size_t drawn = triangles_at(tiles, view, K);
            EXPECT_EQ(count_triangles(tiles, view, ~std::size_t{0}), drawn);
            if (drawn > 100) {
                EXPECT_GT(count_triangles(tiles, view, 50), 50u);
            }
        }
    }
}

TEST(Budget, IsKeptAndAlmostUsedUp) {
    const BallTiles tiles(24, 0.002, hills);
    for (const double height : {2e4, 1e6}) {
        const SegmentView view = view_ahead(height);
        triangles_at(tiles, view, 100);  // loads tiles
        double last = 0;
        for (const std::size_t limit : {8000u, 8003u, 12000u, 20000u, 60000u}) {
            const TriangleBudget b = fit_triangles(tiles, view, limit);
            EXPECT_LE(b.triangles, limit);
            EXPECT_EQ(b.triangles, triangles_at(tiles, view, b.K));
            EXPECT_GE(b.K, last);
            EXPECT_NEAR(b.coarsening, view.test.K / b.K, 1e-12 * b.coarsening);
            if (b.K < view.test.K) {
                EXPECT_GT(triangles_at(tiles, view, b.K * std::exp2(1.0 / 70)), limit);
            }
            last = b.K;
        }
    }
}

TEST(Budget, LeavesAViewThatFitsAsItIs) {
    const BallTiles tiles(20, 0.002, hills);
    const SegmentView view = view_ahead(1e6);
    const TriangleBudget b = fit_triangles(tiles, view, 100'000'000);
    EXPECT_EQ(b.K, view.test.K);
    EXPECT_EQ(b.coarsening, 1);
    EXPECT_EQ(b.triangles, triangles_at(tiles, view, view.test.K));
}

TEST(Budget, SaysHowManyTrianglesThereAreAtLeast) {
    const BallTiles tiles(20, 0.002, hills);
    const SegmentView view = view_ahead(2e7);
    const std::size_t least = triangles_at(tiles, view, 0);
    ASSERT_GT(least, 1u);
    EXPECT_EQ(fit_triangles(tiles, view, least).triangles, least);
    try {
        fit_triangles(tiles, view, least - 1);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::bad_usage);
        EXPECT_NE(std::string(error.what()).find("at least " + std::to_string(least)), std::string::npos)
            << error.what();
    }
}

// Triangles go with K or with its square: the steps settle and stay.
TEST(Budget, StepsSettle) {
    for (const double power : {1.0, 2.0})
        for (const double at_first : {900.0, 1e5, 3e6}) {
            BudgetSteps steps;
            int last = 0, settled = 0;
            for (int frame = 0; frame < 200; ++frame) {
                steps.after_frame(static_cast<std::size_t>(at_first * std::pow(steps.factor(), power)), 10'000);
                settled = steps.step() == last ? settled + 1 : 0;
                last = steps.step();
            }
            EXPECT_GT(settled, 100);
            EXPECT_LE(at_first * std::pow(steps.factor(), power), 10'000);
            EXPECT_EQ(steps.step() == 0, at_first <= 10'000);
            for (int frame = 0; frame < 200; ++frame) steps.after_frame(10, 10'000);
            EXPECT_EQ(steps.step(), 0);
            EXPECT_EQ(steps.factor(), 1);
        }
}

}  // namespace
}  // namespace planet
