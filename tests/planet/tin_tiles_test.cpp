// Tiles: the tolerance at every sample, borders that match, voids, pruning.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "planet/error.h"
#include "planet/tin/border_line.h"
#include "planet/tin/tiled_tin.h"
#include "planet/tin/triangle_scan.h"
#include "planet/tin/void_border.h"
#include "tin_rasters.h"

namespace planet {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// ---- scanning ----

TEST(TinScan, FindsWhatLookingAtEverySampleFinds) {
    const HeightGrid grid = rough_grid(90, 70);
    std::mt19937 random(5);
    const auto any = [&] { return glm::ivec2(random() % 90, random() % 70); };
    for (int i = 0; i < 3000; ++i) {
        const bool small = i % 2 == 0;
        const glm::ivec2 a = any(),
                         b = small ? glm::clamp(a + any() % 9 - 4, glm::ivec2(0), glm::ivec2(89, 69)) : any(),
                         c = small ? glm::clamp(a + any() % 9 - 4, glm::ivec2(0), glm::ivec2(89, 69)) : any();
        const std::int64_t area = orientation(a, b, c);
        if (area == 0) continue;
        const SortedTriangle t({a, b, c}, {grid.at(a), grid.at(b), grid.at(c)});
        double worst = 0;
        glm::ivec2 sample(-1);
        std::size_t inside = 0, spanned = 0;
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 90; ++x) {
                const glm::ivec2 p(x, y);
                const std::int64_t u = orientation(b, c, p), v = orientation(c, a, p), w = orientation(a, b, p);
                if (std::min({u * area, v * area, w * area}) < 0) continue;
                inside += (u != 0) + (v != 0) + (w != 0) > 1;
                const auto h = [&](glm::ivec2 q) { return static_cast<double>(grid.at(q)); };
                const double d = std::abs(static_cast<double>(u) * h(a) + static_cast<double>(v) * h(b) +
                                          static_cast<double>(w) * h(c) - h(p) * static_cast<double>(area)) /
                                 static_cast<double>(std::abs(area));
                if (d > worst) {
                    worst = d;
                    sample = p;
                }
            }
        for_each_span(t, [&](int y, int first, int last) {
            for (int x = first; x <= last; ++x)
                spanned += glm::ivec2(x, y) != a && glm::ivec2(x, y) != b && glm::ivec2(x, y) != c;
            return true;
        });
        EXPECT_EQ(inside, spanned);
        const WorstSample<double> exact = worst_sample<double>(grid, t);
        EXPECT_EQ(exact.deviation, worst) << "whole metres are exact";
        EXPECT_EQ(exact.sample, sample) << "the first in rows";
        EXPECT_NEAR(static_cast<double>(worst_sample<float>(grid, t).deviation), worst, 1e-3);
        EXPECT_TRUE(within(grid, t, static_cast<float>(worst) + 0.01f));
        if (worst > 0.01) {
            EXPECT_FALSE(within(grid, t, static_cast<float>(worst) - 0.01f));
        }
    }
}

TEST(TinScan, PassesOverVoids) {
    HeightGrid grid(20, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) grid.set({x, y}, (x == 7 && y == 3) ? 50 : 0);
    grid.set({5, 2}, nan);
    const SortedTriangle t({glm::ivec2(0, 0), {19, 0}, {19, 19}}, {0, 0, 0});
    EXPECT_EQ(worst_sample<float>(grid, t).deviation, 50);
    EXPECT_EQ(worst_sample<float>(grid, t).sample, glm::ivec2(7, 3));
    grid.set({7, 3}, nan);
    EXPECT_EQ(worst_sample<float>(grid, t).deviation, 0);
    EXPECT_TRUE(within(grid, t, 0));
}

// ---- lines ----

TEST(TinBorderLine, KeepsTheTolerance) {
    const HeightGrid grid = fractional_grid(500, 2);
    const std::vector<float> line(grid.row(0), grid.row(0) + 500);
    std::size_t before = 501;
    for (const double tolerance : {0.0, 1.0, 10.0, 100.0, 1e6}) {
        const std::vector<int> kept = simplified_line(line, {tolerance});
        ASSERT_TRUE(std::is_sorted(kept.begin(), kept.end()));
        EXPECT_EQ(kept.front(), 0);
        EXPECT_EQ(kept.back(), 499);
        EXPECT_LE(kept.size(), before);
        before = kept.size();
        for (std::size_t k = 1; k < kept.size(); ++k)
            for (int i = kept[k - 1]; i <= kept[k]; ++i) {
                const auto h = [&](int j) { return static_cast<double>(line[static_cast<std::size_t>(j)]); };
                const double s = static_cast<double>(i - kept[k - 1]) / (kept[k] - kept[k - 1]);
                EXPECT_LE(std::abs(h(i) - (1 - s) * h(kept[k - 1]) - s * h(kept[k])), tolerance + 1e-9);
            }
    }
    EXPECT_EQ(before, 2u);
}

TEST(TinBorderLine, KeepsBothEndsOfAVoid) {
    EXPECT_EQ(simplified_line({0, 0, 0, nan, nan, nan, nan, 0, 0, 0}, {1}), (std::vector{0, 2, 3, 6, 7, 9}));
    EXPECT_EQ(simplified_line({nan, nan, nan}, {1}), (std::vector{0, 2}));
    EXPECT_EQ(simplified_line({0, 0, 0, 0, 0}, {1}, {3, 1}), (std::vector{0, 1, 3, 4}));
}

// By a metric that adds up a stretch stays while half its length times what it adds up is no more than the least priority.
TEST(TinBorderLine, MayBeKeptByWhatAddsUp) {
    const std::vector<float> line{0, 0, 6, 0, 0, 0, 3, 0, 0};
    const auto kept = [&](TinMetric metric, double least_priority) {
        return simplified_line(line, {0, metric, least_priority});
    };
    EXPECT_EQ(kept(TinMetric::local, 1e9), kept(TinMetric::local, 0)) << "which has no least priority";
    EXPECT_EQ(kept(TinMetric::regional, 4 * 9).size(), 2u);
    EXPECT_EQ(kept(TinMetric::regional, 4 * 9 - 1)[1], 2);
    EXPECT_EQ(kept(TinMetric::rms, 4 * 45).size(), 2u);
    EXPECT_EQ(kept(TinMetric::rms, 4 * 45 - 1)[1], 2);
    EXPECT_EQ(kept(TinMetric::rms, 0), kept(TinMetric::local, 0));
}

// ---- tiles ----

struct Case {
    int width, height, step;
    double tolerance;
};

TEST(TinTiles, KeepTheToleranceAtEverySample) {
    for (const TinQuality quality : {TinQuality::fast, TinQuality::standard, TinQuality::best})
        for (const Case& c : {Case{200, 150, 256, 10},
                              {200, 150, 64, 10},
                              {131, 257, 65, 3},
                              {24, 30, 1, 10},
                              {2, 300, 16, 5},
                              {300, 2, 100, 5},
                              {70, 60, 30, 0},
                              {200, 150, 50, 1e5}})
            for (const bool fractional : {false, true}) {
                const HeightGrid grid = fractional ? fractional_grid(c.width, c.height) : rough_grid(c.width, c.height);
                const TinMesh mesh = tiled_tin(grid, {c.tolerance, quality}, c.step);
                std::size_t border = 0;
                EXPECT_TRUE(sound(mesh, &border));
                EXPECT_EQ(doubled_area(mesh), std::int64_t{2} * (c.width - 1) * (c.height - 1));
                const BruteDeviation d = brute_deviation(mesh, grid);
                EXPECT_LE(d.max, fractional ? c.tolerance + 1e-9 : c.tolerance) << c.width << " " << c.step;
                EXPECT_EQ(d.uncovered, 0u);
                for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
                    ASSERT_EQ(mesh.height[v], grid.at(mesh.vertices[v]));
            }
}

TEST(TinTiles, MatchAtTheirBorders) {
    const HeightGrid grid = rough_grid(257, 257);
    const TinTiling tiling(257, 257, 64);
    ASSERT_EQ(tiling.count(), 16u);
    std::vector<TinTile> tiles(16);
    // Each from a window of its own, as if the raster were larger than memory.
    const WindowReader read = [&](glm::ivec2 low, glm::ivec2 high) { return HeightGrid(grid, low, high); };
    tin_tiles(tiling, read, {8}, [&](TinTile&& tile) { tiles[tile.tile] = std::move(tile); });
    const auto places = [&](std::size_t tile, std::size_t side) {
        std::vector<std::tuple<int, int, float>> out;
        for (const std::uint32_t v : tiles[tile].border[side])
            out.emplace_back(tiles[tile].mesh.vertices[v].x, tiles[tile].mesh.vertices[v].y,
                             tiles[tile].mesh.height[v]);
        return out;
    };
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 4; ++column) {
            const std::size_t i = row * 4 + column;
            EXPECT_TRUE(sound(tiles[i].mesh));
            if (column < 3) {
                EXPECT_EQ(places(i, 3), places(i + 1, 2));
            }
            if (row < 3) {
                EXPECT_EQ(places(i, 1), places(i + 4, 0));
            }
            EXPECT_GT(places(i, 0).size(), 3u);
        }
    const TinMesh whole = joined(tiles), direct = tiled_tin(grid, {8}, 64);
    EXPECT_EQ(whole.triangles, direct.triangles);
    std::size_t border = 0, around = 0;
    ASSERT_TRUE(sound(whole, &border));
    for (const glm::ivec2 p : whole.vertices) around += p.x == 0 || p.y == 0 || p.x == 256 || p.y == 256;
    EXPECT_EQ(border, around) << "no side inside has one triangle only";
    EXPECT_LE(brute_deviation(whole, grid).max, 8);
}

TEST(TinTiles, AreTheSameWhateverTheThreads) {
    const HeightGrid grid = rough_grid(300, 200);
    const TinMesh one = tiled_tin(grid, {6, TinQuality::standard, 1}, 40),
                  many = tiled_tin(grid, {6, TinQuality::standard, 5}, 40);
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_EQ(one.vertices, many.vertices);
}

TEST(TinTiles, APlaneIsFewTriangles) {
    HeightGrid grid(513, 513);
    for (int y = 0; y < 513; ++y)
        for (int x = 0; x < 513; ++x) grid.set({x, y}, static_cast<float>(3 * x - 2 * y));
    EXPECT_EQ(tiled_tin(grid, {0, TinQuality::fast}).triangles.size(), 8u) << "four tiles of two";
}

TEST(TinTiles, PruningTakesVerticesAndKeepsTheTolerance) {
    const HeightGrid grid = rough_grid(300, 300);
    const std::size_t fast = tiled_tin(grid, {10, TinQuality::fast}).triangles.size(),
                      standard = tiled_tin(grid, {10, TinQuality::standard}).triangles.size(),
                      best = tiled_tin(grid, {10, TinQuality::best}).triangles.size();
    EXPECT_LT(static_cast<double>(standard), 0.92 * static_cast<double>(fast));
    EXPECT_LT(best, standard);
}

// Refined up to one bound, by the samples within: what borders have follows from their samples alone.
TEST(TinTiles, GoByMetricsThatAddUp) {
    const HeightGrid grid = fractional_grid(97, 65);
    for (const TinMetric metric : {TinMetric::regional, TinMetric::rms})
        for (const double least_priority : {0.0, 3000.0, 1e9}) {
            TiledTinOptions options{.tolerance = 12, .metric = metric, .least_priority = least_priority};
            const TinMesh mesh = tiled_tin(grid, options, 32);
            std::size_t border = 0;
            EXPECT_TRUE(sound(mesh, &border));
            EXPECT_EQ(doubled_area(mesh), 2 * 96 * 64) << "no gap between tiles";
            const double deviation = brute_deviation(mesh, grid).max;
            if (least_priority == 0) {
                EXPECT_LE(deviation, 12 + 1e-9);
            } else {
                EXPECT_GT(deviation, 12);
            }
            if (least_priority == 1e9) {
                EXPECT_EQ(mesh.triangles.size(), 2u * 6);
            }
            const TinTile tile = tin_tile(grid, {32, 0}, {64, 32}, options);
            const auto expected = tile_border(grid, {32, 0}, {64, 32}, options.bound());
            for (const auto& side : tile.border)
                for (const std::uint32_t v : side)
                    EXPECT_NE(std::ranges::find(expected, tile.mesh.vertices[v]), expected.end());
            EXPECT_EQ(tile.border[0].size() + tile.border[1].size() + tile.border[2].size() + tile.border[3].size(),
                      expected.size());
        }
}

TEST(TinTiles, AFailureOfTheReaderOrTheSinkIsPassedOn) {
    const HeightGrid grid = rough_grid(100, 100);
    const WindowReader read = [&](glm::ivec2 low, glm::ivec2 high) { return HeightGrid(grid, low, high); };
    const auto full = [](TinTile&&) { throw Error(Fault::bad_data, "tile.glb", "no space left"); };
    EXPECT_THROW(tin_tiles(TinTiling(100, 100, 30), read, {5}, full), Error);
    const WindowReader broken = [](glm::ivec2, glm::ivec2) -> HeightGrid {
        throw Error(Fault::bad_data, "dem.tif", "damaged");
    };
    EXPECT_THROW(tin_tiles(TinTiling(100, 100, 30), broken, {5}, [](TinTile&&) {}), Error);
}

// ---- voids ----

HeightGrid with_voids(int width, int height, unsigned seed) {
    HeightGrid grid = rough_grid(width, height, seed);
    std::mt19937 random(seed);
    const auto erase = [&](int x, int y) {
        if (grid.inside({x, y})) grid.set({x, y}, nan);
    };
    for (int k = 0; k < 6; ++k) {  // discs, some over the border
        const int cx = static_cast<int>(random() % static_cast<unsigned>(width)),
                  cy = static_cast<int>(random() % static_cast<unsigned>(height)),
                  r = 2 + static_cast<int>(random() % 12);
        for (int y = cy - r; y <= cy + r; ++y)
            for (int x = cx - r; x <= cx + r; ++x)
                if ((x - cx) * (x - cx) + (y - cy) * (y - cy) <= r * r) erase(x, y);
    }
    for (int k = 0; k < 20; ++k)
        erase(static_cast<int>(random() % static_cast<unsigned>(width)),
              static_cast<int>(random() % static_cast<unsigned>(height)));
    return grid;
}

// Valid samples at which three corners of some unit square are valid: those a triangle can hold.
std::size_t reachable(const HeightGrid& grid) {
    std::set<std::pair<int, int>> reached;
    for (int y = 0; y + 1 < grid.height(); ++y)
        for (int x = 0; x + 1 < grid.width(); ++x) {
            std::vector<glm::ivec2> corners;
            for (const glm::ivec2 p : {glm::ivec2(x, y), {x + 1, y}, {x, y + 1}, {x + 1, y + 1}})
                if (grid.valid(p)) corners.push_back(p);
            if (corners.size() >= 3)
                for (const glm::ivec2 p : corners) reached.insert({p.x, p.y});
        }
    return reached.size();
}

TEST(TinVoids, NothingOverAHoleAndNothingLeftOut) {
    for (unsigned seed = 1; seed <= 6; ++seed)
        for (const int step : {256, 17}) {
            const HeightGrid grid = with_voids(120, 100, seed);
            const TinMesh mesh = tiled_tin(grid, {10, seed % 2 ? TinQuality::fast : TinQuality::best}, step);
            EXPECT_TRUE(sound(mesh));
            const BruteDeviation d = brute_deviation(mesh, grid);
            EXPECT_EQ(d.voids, 0u);
            EXPECT_LE(d.max, 10);
            EXPECT_EQ(d.uncovered, grid.valid_samples() - reachable(grid));
            std::int64_t area = 0;  // what unit squares of valid corners hold
            for (int y = 0; y + 1 < 100; ++y)
                for (int x = 0; x + 1 < 120; ++x) {
                    const int corners = grid.valid({x, y}) + grid.valid({x + 1, y}) + grid.valid({x, y + 1}) +
                                        grid.valid({x + 1, y + 1});
                    area += corners == 4 ? 2 : corners == 3 ? 1 : 0;
                }
            EXPECT_EQ(doubled_area(mesh), area);
        }
}

TEST(TinVoids, TilesOfVoidsOnlyAreEmpty) {
    HeightGrid grid = rough_grid(65, 33);
    for (int y = 0; y < 33; ++y)
        for (int x = 0; x < 40; ++x) grid.set({x, y}, nan);
    const TinTile tile = tin_tile(grid, {0, 0}, {32, 32}, {5});
    EXPECT_TRUE(tile.mesh.triangles.empty());
    EXPECT_TRUE(tile.mesh.vertices.empty());
    EXPECT_FALSE(tiled_tin(grid, {5}, 32).triangles.empty());
}

TEST(TinHeightGrid, RefusesWhatHasNoArea) {
    Raster raster;
    raster.name = "thin.tif";
    raster.width = 1;
    raster.height = 5;
    raster.samples = std::vector<float>(5, 1);
    EXPECT_THROW(HeightGrid{raster}, Error);
    raster.width = raster.height = 2;
    raster.samples = std::vector<float>(4, nan);
    EXPECT_THROW(HeightGrid{raster}, Error);
    raster.samples = std::vector<std::int16_t>{5, void_sample, water_sample, 7};
    raster.scale = 0.1;
    raster.offset = 2;
    const HeightGrid grid(raster);
    EXPECT_EQ(grid.valid_samples(), 3u);
    EXPECT_TRUE(grid.has_void());
    EXPECT_EQ(grid.at({0, 1}), 0) << "water";
    EXPECT_EQ(grid.at({0, 0}), 2.5f);
    EXPECT_GT(grid.sample_rounding(), 0);
    EXPECT_LT(grid.sample_rounding(), 1e-6);
}

}  // namespace
}  // namespace planet
