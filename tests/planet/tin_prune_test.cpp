// What pruning leaves out: vertices tried in vain before, and measurements that floats decide.
#include "planet/tin/prune.h"

#include <gtest/gtest.h>

#include "planet/tin/greedy_tin.h"
#include "planet/tin/triangle_scan.h"
#include "planet/tin/void_border.h"
#include "tin_rasters.h"

namespace planet {
namespace {

using Index = Delaunay::Index;

Delaunay inserted(const HeightGrid& grid, double tolerance) {
    Delaunay mesh = coarsest_tin(grid);
    GreedyOptions options;
    options.tolerance = tolerance;
    insert_greedily(mesh, grid, options);
    return mesh;
}

TEST(TinPrune, EndsWhereNoVertexCanGoAnyMore) {
    for (const bool fractional : {false, true})
        for (const double tolerance : {4.0, 12.5, 40.0}) {
            const HeightGrid grid = fractional ? fractional_grid(160, 120) : rough_grid(160, 120);
            Delaunay mesh = inserted(grid, tolerance);
            const std::size_t before = mesh.vertex_count(), removed = prune(mesh, grid, {tolerance, 100});
            EXPECT_GT(removed, before / 20);
            EXPECT_EQ(mesh.vertex_count(), before - removed);
            EXPECT_EQ(mesh.check(), "");
            EXPECT_LE(brute_deviation(triangles_over_samples(mesh, grid), grid).max, tolerance);
            EXPECT_EQ(prune(mesh, grid, {tolerance, 1}), 0u) << "tried all over again";
        }
}

TEST(TinPrune, KeepsWhatHasToStayWhateverGoesBesideIt) {
    const HeightGrid grid = rough_grid(100, 80);
    Delaunay mesh = inserted(grid, 20);
    std::vector<std::uint8_t> keep(mesh.vertex_slots(), 0);
    for (std::size_t v = 0; v < keep.size(); v += 3) keep[v] = 1;
    prune(mesh, grid, {20, 100, keep});
    for (Index v = 0; v < keep.size(); ++v) EXPECT_TRUE(keep[v] == 0 || mesh.vertex_alive(v)) << v;
}

TEST(TinPrune, ARemovalRefusedOnTheWayChangesNothing) {
    const HeightGrid grid = rough_grid(60, 50);
    Delaunay mesh = inserted(grid, 30);
    const std::size_t triangles = mesh.triangle_count();
    std::size_t asked = 0, refused = 0;
    for (Index v = 0; v < mesh.vertex_slots(); ++v) {
        if (!mesh.plan_removal(v)) continue;
        const std::vector<std::array<Index, 3>> filling(mesh.filling().begin(), mesh.filling().end());
        std::vector<std::array<Index, 3>> seen;
        EXPECT_TRUE(mesh.plan_removal(v, [&](const std::array<Index, 3>& t) {
            seen.push_back(t);
            return true;
        }));
        EXPECT_EQ(seen, filling);
        asked = 0;
        EXPECT_FALSE(mesh.plan_removal(v, [&](const std::array<Index, 3>&) { return ++asked < filling.size(); }));
        EXPECT_EQ(asked, filling.size());
        ++refused;
    }
    EXPECT_GT(refused, 20u);
    EXPECT_EQ(mesh.triangle_count(), triangles);
    EXPECT_EQ(mesh.check(), "");
}

TEST(TinScan, WhereFloatsDecideDoublesSayTheSame) {
    const HeightGrid grid = rough_grid(400, 300);
    ASSERT_TRUE(grid.whole_metres());
    std::mt19937 random(5);
    const auto within_grid = [&](int size) { return static_cast<int>(random() % static_cast<unsigned>(size)); };
    std::size_t decided = 0, left_open = 0;
    for (int i = 0; i < 20000; ++i) {
        const int reach = i % 2 == 0 ? 25 : 300;  // small triangles, and some of all sizes
        std::array<glm::ivec2, 3> p;
        p[0] = {within_grid(400), within_grid(300)};
        for (std::size_t k = 1; k < 3; ++k)
            p[k] = glm::clamp(p[0] + glm::ivec2(within_grid(2 * reach) - reach, within_grid(2 * reach) - reach),
                              glm::ivec2(0), glm::ivec2(399, 299));
        if (orientation(p[0], p[1], p[2]) == 0) continue;
        const SortedTriangle t(p, {grid.at(p[0]), grid.at(p[1]), grid.at(p[2])});
        const double exact = worst_sample<double>(grid, t).deviation;
        // The hardest tolerance: a whole number right at the deviation.
        for (const double tolerance : {std::floor(exact), std::ceil(exact)}) {
            if (!floats_decide(grid, t, tolerance)) {
                ++left_open;
                continue;
            }
            ++decided;
            EXPECT_EQ(within(grid, t, static_cast<float>(tolerance)), exact <= tolerance);
            const float farthest = worst_sample<float>(grid, t).deviation;
            EXPECT_EQ(farthest <= static_cast<float>(tolerance), exact <= tolerance);
        }
    }
    EXPECT_GT(decided, 5000u);
    EXPECT_GT(left_open, 1000u);
}

TEST(TinScan, FloatsDecideWholeMetresOnly) {
    const SortedTriangle t({glm::ivec2(0, 0), glm::ivec2(5, 0), glm::ivec2(0, 5)}, {1, 2, 3});
    EXPECT_TRUE(floats_decide(rough_grid(10, 10), t, 5));
    EXPECT_FALSE(floats_decide(rough_grid(10, 10), t, 5.5));
    EXPECT_FALSE(floats_decide(fractional_grid(10, 10), t, 5));
    HeightGrid high = rough_grid(10, 10);
    high.set({3, 3}, 0x1p22f);
    EXPECT_FALSE(floats_decide(high, t, 5));
    HeightGrid with_void = rough_grid(10, 10);
    with_void.set({3, 3}, std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(floats_decide(with_void, t, 5));
}

}  // namespace
}  // namespace planet
