// Features cut where tiles meet.

#include "planet/tin/tiled_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tin_rasters.h"

namespace planet {
namespace {

bool within(const TinTiling& tiling, std::size_t tile, glm::ivec2 p) {
    return glm::clamp(p, tiling.low(tile), tiling.high(tile)) == p;
}

TEST(TinTiling, KnowsTheTilesOfASample) {
    for (const auto& [width, height, step] : {std::tuple(41, 33, 8), {42, 34, 8}, {2, 9, 1}, {40, 33, 64}, {9, 7, 1}}) {
        const TinTiling tiling(width, height, step);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                std::vector<std::size_t> expected;
                for (std::size_t i = 0; i < tiling.count(); ++i)
                    if (within(tiling, i, {x, y})) expected.push_back(i);
                EXPECT_EQ(tiling.tiles_at({x, y}), expected) << x << ',' << y;
            }
    }
}

TEST(TinTiledFeatures, StayInTheirTilesAndMeetOnBorders) {
    const TinTiling tiling(70, 60, 16);
    std::mt19937 random(3);
    const auto any = [&] { return glm::ivec2(random() % 70, random() % 60); };
    for (int i = 0; i < 500; ++i) {
        const glm::ivec2 a = any(), b = any();
        const auto needs = cut_into_tiles({{}, {{a, b}}}, tiling);
        double length = 0;
        std::vector<glm::ivec2> ends;
        for (const auto& [tile, need] : needs) {
            EXPECT_TRUE(need.features.points.empty());
            for (const auto& line : need.features.lines) {
                ASSERT_EQ(line.size(), 2u);
                length += glm::distance(glm::dvec2(line[0]), glm::dvec2(line[1]));
                for (const glm::ivec2 p : line) {
                    EXPECT_TRUE(within(tiling, tile, p));
                    ends.push_back(p);
                    const auto sharing = tiling.tiles_at(p);
                    if (sharing.size() < 2) continue;
                    for (const std::size_t other : sharing)
                        EXPECT_NE(std::ranges::find(needs.at(other).border, p), needs.at(other).border.end());
                }
            }
        }
        if (a == b) continue;
        // A chain: every sample but the ends is where two parts meet.
        const double whole = glm::distance(glm::dvec2(a), glm::dvec2(b));
        EXPECT_GE(length, whole - 1e-9);
        EXPECT_LE(length, whole + 0.5 * static_cast<double>(ends.size()));
        for (const glm::ivec2 p : ends) {
            EXPECT_EQ(std::ranges::count(ends, p), p == a || p == b ? 1 : 2);
            const glm::dvec2 along = glm::dvec2(b - a) / whole, from = glm::dvec2(p - a);
            EXPECT_LE(std::abs(along.x * from.y - along.y * from.x), 0.5 + 1e-9) << "half a sample off";
        }
    }
}

TEST(TinTiledFeatures, PointsBelongToOneTile) {
    const TinTiling tiling(41, 33, 16);
    const auto needs = cut_into_tiles({{{16, 16}, {5, 16}, {7, 8}, {0, 0}}, {}}, tiling);
    std::size_t points = 0, borders = 0;
    for (const auto& [tile, need] : needs) {
        points += need.features.points.size();
        borders += need.border.size();
    }
    EXPECT_EQ(points, 4u);
    EXPECT_EQ(borders, 4u + 2);
}

// With what was asked of both, tiles fit, and what was asked is there.
TEST(TinTiledFeatures, TilesHaveThemAndFit) {
    const HeightGrid grid = rough_grid(65, 65);
    const TinTiling tiling(65, 65, 32);
    const TinFeatures features{{{32, 11}, {40, 40}}, {{{3, 5}, {61, 50}}, {{32, 60}, {10, 60}}}};
    const auto needs = cut_into_tiles(features, tiling);
    std::vector<TinTile> tiles(4);
    FeatureReport found;
    for (std::size_t i = 0; i < 4; ++i) {
        tiles[i] = tin_tile(grid, tiling.low(i), tiling.high(i), {40}, {0, 0}, needs.at(i));
        tiles[i].tile = i;
        found += tiles[i].features;
    }
    EXPECT_EQ(found.points + found.duplicates, 2u);
    const TinMesh whole = joined(std::move(tiles));
    std::size_t border = 0, around = 0;
    ASSERT_TRUE(sound(whole, &border));
    for (const glm::ivec2 p : whole.vertices) around += p.x == 0 || p.y == 0 || p.x == 64 || p.y == 64;
    EXPECT_EQ(border, around) << "no side inside has one triangle only";
    EXPECT_LE(brute_deviation(whole, grid).max, 40);
    for (const glm::ivec2 p : {glm::ivec2(32, 11), {40, 40}, {3, 5}, {61, 50}, {32, 60}, {10, 60}})
        EXPECT_NE(std::ranges::find(whole.vertices, p), whole.vertices.end());
}

}  // namespace
}  // namespace planet
