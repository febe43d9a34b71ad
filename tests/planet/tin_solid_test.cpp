// Solids below TINs: closed, turned outwards, also where holes touch.

#include "planet/tin/tin_solid.h"

#include <gtest/gtest.h>

#include <set>

#include "planet/tin/make_tin.h"
#include "tin_rasters.h"

namespace planet {
namespace {

struct Closed {
    std::size_t open = 0, wrong = 0;
    long euler = 0;
    std::int64_t doubled_floor_area = 0;
};

Closed look_at(const TinSolid& solid) {
    Closed out;
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    std::set<std::uint32_t> used;
    const auto add = [&](const std::array<std::uint32_t, 3>& t) {
        for (std::size_t k = 0; k < 3; ++k) {
            out.wrong += !sides.insert({t[k], t[(k + 1) % 3]}).second;
            used.insert(t[k]);
        }
    };
    for (const auto& t : solid.top.triangles) add(t);
    for (const auto& t : solid.below) add(t);
    for (const auto& [a, b] : sides) out.open += !sides.contains({b, a});
    out.euler = static_cast<long>(used.size()) - static_cast<long>(sides.size() / 2) +
                static_cast<long>(solid.top.triangles.size() + solid.below.size());
    const auto first = solid.top.vertices.size();
    for (const auto& t : solid.below) {
        if (t[0] < first || t[1] < first || t[2] < first) continue;
        out.doubled_floor_area +=
            orientation(solid.floor[t[0] - first], solid.floor[t[1] - first], solid.floor[t[2] - first]);
    }
    EXPECT_EQ(used.size(), first + solid.floor.size()) << "all vertices are used";
    return out;
}

TinSolid solid_of(const HeightGrid& grid, double tolerance) {
    return solid_below(make_tin(grid, {.tolerance = tolerance}).mesh, {grid.width() - 1, grid.height() - 1});
}

TEST(TinSolid, IsABallOverARasterWithoutVoids) {
    const HeightGrid grid = rough_grid(70, 50);
    for (const double tolerance : {0.0, 10.0, 1e6}) {
        const Closed closed = look_at(solid_of(grid, tolerance));
        EXPECT_EQ(closed.open, 0u);
        EXPECT_EQ(closed.wrong, 0u);
        EXPECT_EQ(closed.euler, 2);
        EXPECT_EQ(closed.doubled_floor_area, -2 * 69 * 49) << "it faces down";
    }
}

TEST(TinSolid, FloorHasNoVertexWithin) {
    const TinSolid solid = solid_of(rough_grid(70, 50), 10);
    for (const glm::ivec2 p : solid.floor) EXPECT_TRUE(p.x == 0 || p.y == 0 || p.x == 69 || p.y == 49);
    EXPECT_LT(solid.floor.size(), solid.top.vertices.size());
}

TEST(TinSolid, HolesGoThrough) {
    HeightGrid grid = rough_grid(40, 40);
    for (int y = 10; y < 20; ++y)
        for (int x = 10; x < 25; ++x) grid.set({x, y}, std::nanf(""));
    const TinSolid solid = solid_of(grid, 20);
    const Closed closed = look_at(solid);
    EXPECT_EQ(closed.open, 0u);
    EXPECT_EQ(closed.wrong, 0u);
    EXPECT_EQ(closed.euler, 0) << "a ring";
    EXPECT_EQ(closed.doubled_floor_area, -doubled_area(solid.top));
}

// Voids at random: parts that touch at corners, islands, single triangles.
TEST(TinSolid, IsClosedHoweverVoidsTouch) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        HeightGrid grid = rough_grid(24, 20, seed);
        std::mt19937 random(seed);
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 24; ++x)
                if (random() % 12 < seed) grid.set({x, y}, std::nanf(""));
        if (grid.valid_samples() < 4) continue;
        TinMesh mesh = make_tin(grid, {.tolerance = 5}).mesh;
        if (mesh.triangles.empty()) continue;
        const std::size_t before = mesh.vertices.size();
        const TinSolid solid = solid_below(std::move(mesh), {23, 19});
        const Closed closed = look_at(solid);
        EXPECT_EQ(closed.open, 0u) << seed;
        EXPECT_EQ(closed.wrong, 0u) << seed;
        EXPECT_EQ(closed.doubled_floor_area, -doubled_area(solid.top)) << seed;
        if (seed != 4) continue;
        EXPECT_GT(solid.top.vertices.size(), before) << "some vertices were divided, or this tests little";
    }
}

}  // namespace
}  // namespace planet
