// Features and masks in TINs, and all steps together.

#include "planet/tin/tin_features.h"

#include <gtest/gtest.h>

#include <set>

#include "planet/error.h"
#include "planet/tin/make_tin.h"
#include "planet/tin/void_border.h"
#include "tin_rasters.h"

namespace planet {
namespace {

using Index = Delaunay::Index;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// A raster in metres, rows southwards, sample (0, 0) at (1000, 2000).
Raster metric_raster(int width, int height) {
    Raster raster;
    raster.name = "dem.tif";
    raster.width = width;
    raster.height = height;
    raster.plain = true;
    raster.grid = {{1000, 2000}, {10, 0}, {0, -10}};
    raster.samples = std::vector<float>(raster.count(), 0);
    return raster;
}

std::set<std::pair<int, int>> places(const TinMesh& mesh) {
    std::set<std::pair<int, int>> out;
    for (const glm::ivec2 p : mesh.vertices) out.insert({p.x, p.y});
    return out;
}

// Whether sides of the mesh lead straight from one sample to another.
bool has_line(const TinMesh& mesh, glm::ivec2 a, glm::ivec2 b) {
    std::map<std::pair<int, int>, std::vector<glm::ivec2>> beside;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 p = mesh.vertices[t[k]], q = mesh.vertices[t[(k + 1) % 3]];
            beside[{p.x, p.y}].push_back(q);
            beside[{q.x, q.y}].push_back(p);
        }
    while (a != b) {
        glm::ivec2 next = a;
        for (const glm::ivec2 q : beside[{a.x, a.y}])
            if (orientation(a, b, q) == 0 && glm::dot(glm::dvec2(q - a), glm::dvec2(b - a)) > 0) next = q;
        if (next == a) return false;
        a = next;
    }
    return true;
}

TEST(TinFeatures, AreThereExactlyAndTheToleranceHolds) {
    const HeightGrid grid = rough_grid(120, 100);
    for (const TinQuality quality : {TinQuality::fast, TinQuality::best}) {
        TinOptions options{.tolerance = 15, .quality = quality};
        options.features.points = {{3, 3}, {50, 77}, {119, 99}, {0, 50}};
        options.features.lines = {{{10, 10}, {90, 33}, {91, 80}}, {{0, 60}, {119, 61}}, {{5, 5}, {5, 95}}};
        const TinResult result = make_tin(grid, options);
        EXPECT_EQ(result.features.points, 3u) << "one is a corner";
        EXPECT_EQ(result.features.duplicates, 1u);
        EXPECT_EQ(result.features.crossings, 2u);
        EXPECT_EQ(result.features.dropped, 0u);
        EXPECT_TRUE(sound(result.mesh));
        const auto at = places(result.mesh);
        for (const glm::ivec2 p : options.features.points) EXPECT_TRUE(at.contains({p.x, p.y}));
        EXPECT_TRUE(has_line(result.mesh, {10, 10}, {90, 33}));
        EXPECT_LE(brute_deviation(result.mesh, grid).max, 15);
        EXPECT_EQ(brute_deviation(result.mesh, grid).uncovered, 0u);
    }
}

TEST(TinFeatures, LinesThatCrossShareASample) {
    const HeightGrid grid = rough_grid(41, 41);
    Delaunay mesh = coarsest_tin(grid);
    const FeatureReport report = insert_features(mesh, grid, {{}, {{{0, 0}, {40, 40}}, {{0, 40}, {40, 0}}}});
    EXPECT_EQ(report.crossings, 1u);
    EXPECT_EQ(mesh.check(), "");
    EXPECT_NE(mesh.locate({20, 20}).vertex, Delaunay::none);
    const TinMesh tin = triangles_over_samples(mesh, grid);
    for (const glm::ivec2 corner : {glm::ivec2(0, 0), {40, 40}, {0, 40}, {40, 0}})
        EXPECT_TRUE(has_line(tin, corner, {20, 20}));
}

TEST(TinFeatures, AnyCrowdOfLinesEndsUpSound) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937 random(seed);
        const unsigned size = seed % 2 ? 12 : 90;
        const HeightGrid grid = rough_grid(static_cast<int>(size), static_cast<int>(size));
        TinFeatures features;
        for (int i = 0; i < 25; ++i)
            features.lines.push_back({{random() % size, random() % size}, {random() % size, random() % size}});
        features.lines.push_back(features.lines.front());
        Delaunay mesh = coarsest_tin(grid);
        const FeatureReport report = insert_features(mesh, grid, features);
        EXPECT_EQ(mesh.check(), "") << seed;
        EXPECT_EQ(report.dropped, 0u) << seed;
        EXPECT_GT(report.crossings, 10u);
        for (const auto& line : features.lines)
            for (const glm::ivec2 p : line) EXPECT_NE(mesh.locate(p).vertex, Delaunay::none);
        insert_greedily(mesh, grid, {.tolerance = 20});
        EXPECT_EQ(mesh.check(), "");
    }
}

TEST(TinFeatures, StayOutOfVoids) {
    HeightGrid grid = rough_grid(60, 60);
    for (int y = 20; y < 40; ++y)
        for (int x = 25; x < 35; ++x) grid.set({x, y}, nan);
    Delaunay mesh = coarsest_tin(grid);
    const FeatureReport report = insert_features(
        mesh, grid, {{{30, 30}, {5, 5}}, {{{2, 30}, {57, 31}}, {{2, 2}, {50, 3}}, {{24, 10}, {24, 55}}}});
    EXPECT_EQ(report.over_voids, 1u);
    EXPECT_EQ(report.points, 1u);
    EXPECT_EQ(report.around_voids, 2u);
    EXPECT_EQ(report.line_sides, 1u);
    insert_greedily(mesh, grid, {.tolerance = 20});
    EXPECT_EQ(mesh.check(), "");
    const TinMesh tin = triangles_over_samples(mesh, grid);
    EXPECT_TRUE(sound(tin));
    EXPECT_EQ(brute_deviation(tin, grid).voids, 0u);
    EXPECT_EQ(brute_deviation(tin, grid).uncovered, 0u);
}

TEST(TinFeatures, ABudgetSmallerThanTheyNeedIsRefused) {
    const HeightGrid grid = rough_grid(50, 50);
    TinOptions options{.max_triangles = 10};
    for (int i = 1; i < 20; ++i) options.features.points.push_back({2 * i, 2 * i});
    try {
        make_tin(grid, options);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_usage);
        EXPECT_NE(std::string(e.what()).find("10 are fewer than"), std::string::npos) << e.what();
    }
    options.max_triangles = 60;
    EXPECT_LE(make_tin(grid, options).mesh.triangles.size(), 60u);
}

// ---- from coordinates ----

TEST(TinFeatures, GoToTheNearestSample) {
    Features features;
    features.points = {{1004, 1996, 7}, {1096, 1951, 0}, {900, 2000, 0}, {1104.9, 1945.1, 0}, {1000, 1944, 0}};
    const TinFeatures at = features_at_samples(features, metric_raster(11, 6));
    EXPECT_EQ(at.points, (std::vector<glm::ivec2>{{0, 0}, {10, 5}, {10, 5}}));
    EXPECT_EQ(at.outside, 2u);
}

TEST(TinFeatures, LinesAreCutAtTheBorder) {
    Features features;
    features.lines = {{{900, 1975, 0}, {1200, 1975, 0}},                    // through
                      {{1050, 1990, 0}, {1050, 2100, 0}, {1080, 1990, 0}},  // out and in again
                      {{900, 900, 0}, {950, 900, 0}},                       // beside
                      {{1010, 1990, 0}, {1011, 1991, 0}}};                  // within one sample
    const TinFeatures at = features_at_samples(features, metric_raster(11, 6));
    ASSERT_EQ(at.lines.size(), 3u);
    EXPECT_EQ(at.lines[0].front().x, 0);
    EXPECT_EQ(at.lines[0].back().x, 10);
    EXPECT_EQ(at.lines[1], (std::vector<glm::ivec2>{{5, 1}, {5, 0}}));
    EXPECT_EQ(at.lines[2].back(), glm::ivec2(8, 1));
    EXPECT_EQ(at.points, (std::vector<glm::ivec2>{{1, 1}}));
    EXPECT_EQ(at.outside, 4u);
}

TEST(TinMask, KeepsWhatIsWithin) {
    const Raster raster = metric_raster(21, 21);
    HeightGrid grid(raster);
    Polygon square;
    square.outer = {{1045, 1955, 0}, {1145, 1955, 0}, {1145, 1855, 0}, {1045, 1855, 0}, {1045, 1955, 0}};
    square.holes = {{{1075, 1925, 0}, {1105, 1925, 0}, {1105, 1895, 0}, {1075, 1895, 0}, {1075, 1925, 0}}};
    keep_within(grid, raster, {square});
    EXPECT_EQ(grid.valid_samples(), 100u - 9u);
    EXPECT_TRUE(grid.valid({5, 5}));
    EXPECT_TRUE(grid.valid({14, 14}));
    EXPECT_FALSE(grid.valid({9, 9}));
    EXPECT_FALSE(grid.valid({15, 10}));
    const TinResult result = make_tin(grid, {.tolerance = 1});
    EXPECT_EQ(doubled_area(result.mesh), 2 * (81 - 16) + 4) << "half of each square at a corner of the hole stays";
    EXPECT_EQ(brute_deviation(result.mesh, grid).voids, 0u);
}

TEST(TinMask, ThatLeavesNothingIsRefused) {
    const Raster raster = metric_raster(21, 21);
    HeightGrid grid(raster);
    Polygon far;
    far.outer = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 0, 0}};
    EXPECT_THROW(keep_within(grid, raster, {far}), Error);
}

// ---- all steps ----

TEST(TinMaking, PruningMakesABudgetGoFurther) {
    const HeightGrid grid = rough_grid(200, 200);
    double before = std::numeric_limits<double>::infinity();
    for (const TinQuality quality : {TinQuality::fast, TinQuality::standard, TinQuality::best}) {
        const TinResult result = make_tin(grid, {.max_triangles = 1500, .quality = quality});
        EXPECT_EQ(result.end, GreedyEnd::budget);
        EXPECT_LE(result.mesh.triangles.size(), 1500u);
        EXPECT_GE(result.mesh.triangles.size(), 1498u);
        EXPECT_TRUE(sound(result.mesh));
        const double now = brute_deviation(result.mesh, grid).max;
        EXPECT_LE(now, quality == TinQuality::standard ? 0.97 * before : before);
        before = now;
    }
}

TEST(TinMaking, EveryWayKeepsTheTolerance) {
    const HeightGrid grid = rough_grid(150, 150);
    for (const TinMetric metric : {TinMetric::local, TinMetric::regional, TinMetric::rms})
        for (const TinQuality quality : {TinQuality::fast, TinQuality::standard, TinQuality::best}) {
            const TinResult result = make_tin(grid, {.tolerance = 12, .quality = quality, .metric = metric});
            EXPECT_EQ(result.end, GreedyEnd::tolerance);
            EXPECT_TRUE(sound(result.mesh));
            EXPECT_LE(brute_deviation(result.mesh, grid).max, 12);
            EXPECT_FALSE(result.seconds.empty());
        }
}

TEST(TinMaking, RefusesAToleranceOutOfRange) {
    EXPECT_THROW(make_tin(rough_grid(10, 10), {.tolerance = -1}), Error);
    EXPECT_THROW(make_tin(rough_grid(10, 10), {.tolerance = std::nan("")}), Error);
}

TEST(TinMask, WindowsAgreeWithTheWhole) {
    const Raster raster = metric_raster(50, 40);
    const std::vector<Polygon> mask{{{{1003, 1998, 0}, {1380, 1955, 0}, {1222, 1631, 0}, {1003, 1998, 0}}, {}},
                                    {{{1300, 1700, 0}, {1495, 1700, 0}, {1495, 1605, 0}, {1300, 1700, 0}}, {}}};
    HeightGrid whole(raster);
    keep_within(whole, raster, mask);
    for (const glm::ivec2 first : {glm::ivec2(0, 0), {7, 11}, {30, 20}}) {
        HeightGrid window(HeightGrid(raster), first, first + glm::ivec2(19, 19));
        keep_window_within(window, first, raster, mask);
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 20; ++x)
                EXPECT_EQ(window.valid({x, y}), whole.valid(first + glm::ivec2(x, y))) << x << ',' << y;
    }
    HeightGrid nothing(HeightGrid(raster), {0, 30}, {5, 39});
    EXPECT_NO_THROW(keep_window_within(nothing, {0, 30}, raster, mask));
    EXPECT_EQ(nothing.valid_samples(), 0u);
}

TEST(MakeTin, ALargeToleranceDoesNotShowTheTiles) {
    const HeightGrid grid = rough_grid(600, 600);
    EXPECT_EQ(make_tin(grid, {.tolerance = 1e6}).mesh.triangles.size(), 2u);
}

}  // namespace
}  // namespace planet
