// Samples that go into TINs as they are: only what is around them changes.

#include "planet/tin/tin_mending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "planet/tin/make_tin.h"
#include "planet/tin/tin_solid.h"
#include "tin_rasters.h"

namespace planet {
namespace {

using Place = std::array<int, 2>;
using Corners = std::array<Place, 3>;

// Of a triangle, from its least on.
Corners corners(const TinMesh& mesh, std::size_t triangle) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::ivec2 p = mesh.vertices[mesh.triangles[triangle][k]];
        c[k] = {p.x, p.y};
    }
    std::ranges::rotate(c, std::ranges::min_element(c));
    return c;
}

// That holds a sample at none of its corners.
std::uint32_t triangle_of(const TinMesh& mesh, glm::ivec2 p) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& t = mesh.triangles[i];
        bool holds = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 a = mesh.vertices[t[k]], b = mesh.vertices[t[(k + 1) % 3]];
            holds = holds && a != p && orientation(a, b, p) >= 0;
        }
        if (holds) return i;
    }
    ADD_FAILURE() << "no triangle holds " << p.x << ", " << p.y;
    return 0;
}

bool has_vertex(const TinMesh& mesh, glm::ivec2 p) {
    return std::ranges::find(mesh.vertices, p) != mesh.vertices.end();
}

bool has_side(const TinMesh& mesh, glm::ivec2 a, glm::ivec2 b) {
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (mesh.vertices[t[k]] == a && mesh.vertices[t[(k + 1) % 3]] == b) return true;
    return false;
}

// Samples that are no vertices, some on the outer border, some on sides between tiles.
std::vector<glm::ivec2> some_samples(const TinMesh& mesh, const HeightGrid& grid) {
    std::vector<glm::ivec2> found;
    for (int y = 0; y < grid.height(); y += 37)
        for (int x = 0; x < grid.width(); x += 32)
            if (grid.valid({x, y}) && !has_vertex(mesh, {x, y})) found.emplace_back(x, y);
    return found;
}

TEST(TinMending, ChangesOnlyWhatIsAroundASample) {
    const HeightGrid grid = rough_grid(400, 300);
    const TinMesh mesh = tiled_tin(grid, {.tolerance = 40}, 64);
    TinMending mending(mesh);
    const TinMesh same = mending.mesh(grid);
    EXPECT_EQ(same.vertices, mesh.vertices);
    EXPECT_EQ(same.triangles, mesh.triangles);
    const std::vector<glm::ivec2> samples = some_samples(mesh, grid);
    ASSERT_GT(samples.size(), 50u);
    for (const glm::ivec2 p : samples) {
        const TinMesh before = mending.mesh(grid);
        ASSERT_TRUE(mending.insert(p, triangle_of(before, p)));
        const TinMesh after = mending.mesh(grid);
        const std::vector<std::uint32_t> changed = mending.take_changed();
        EXPECT_TRUE(std::ranges::is_sorted(changed));
        EXPECT_LT(changed.size(), 60u);
        EXPECT_TRUE(has_vertex(after, p));
        for (std::uint32_t t = 0; t < after.triangles.size(); ++t) {
            const bool known = t < before.triangles.size() && corners(before, t) == corners(after, t);
            EXPECT_EQ(known, !std::ranges::binary_search(changed, t));
        }
    }
    const TinMesh mended = mending.mesh(grid);
    EXPECT_TRUE(sound(mended));
    EXPECT_EQ(doubled_area(mended), 2 * 399 * 299);
    EXPECT_EQ(mended.vertices.size(), mesh.vertices.size() + samples.size());
}

TEST(TinMending, LeavesATriangleThatHasChangedToBeMeasured) {
    const HeightGrid grid = rough_grid(40, 30);
    TinMending mending(tiled_tin(grid, {.tolerance = 1e6}, 64));
    const TinMesh mesh = mending.mesh(grid);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    const std::uint32_t t = triangle_of(mesh, {30, 10});
    EXPECT_TRUE(mending.insert({30, 10}, t));
    EXPECT_FALSE(mending.insert({31, 11}, t));
    EXPECT_EQ(mending.mesh(grid).vertices.size(), 5u);
    mending.take_changed();
    EXPECT_TRUE(mending.insert({31, 11}, triangle_of(mending.mesh(grid), {31, 11})));
}

// A line stays although no circle would have it, divided where a sample on it goes in.
TEST(TinMending, KeepsWhatFeaturesHold) {
    const HeightGrid grid = rough_grid(300, 290);
    const TinMesh mesh = make_tin(grid, {.tolerance = 150, .features = {{}, {{{3, 3}, {283, 143}}}}}).mesh;
    ASSERT_FALSE(mesh.held_sides.empty());
    TinMending mending(mesh);
    for (int x = 9; x < 280; x += 6)
        for (const int off : {-1, 0, 1}) {
            const glm::ivec2 p(x, 3 + (x - 3) / 2 + off);
            const TinMesh now = mending.mesh(grid);
            if (!has_vertex(now, p)) mending.insert(p, triangle_of(now, p));
            mending.take_changed();
        }
    const TinMesh mended = mending.mesh(grid);
    EXPECT_TRUE(sound(mended));
    std::vector<glm::ivec2> on_line;
    for (const glm::ivec2 p : mended.vertices)
        if (orientation({3, 3}, {283, 143}, p) == 0 && p.x >= 3 && p.x <= 283) on_line.push_back(p);
    std::ranges::sort(on_line, {}, [](glm::ivec2 p) { return p.x; });
    EXPECT_GT(on_line.size(), 40u);
    for (std::size_t i = 1; i < on_line.size(); ++i) EXPECT_TRUE(has_side(mended, on_line[i - 1], on_line[i]));
    EXPECT_EQ(mended.held_sides.size() + 1, on_line.size()) << "held still";
}

TEST(TinMending, LeavesHolesAsTheyAre) {
    HeightGrid grid = rough_grid(200, 180);
    for (int y = 40; y < 90; ++y)
        for (int x = 50; x < 90 + y % 7; ++x) grid.set({x, y}, std::nanf(""));
    for (int x = 120; x < 140; ++x) {  // two holes that touch at a corner
        grid.set({x, 100 + (x < 130)}, std::nanf(""));
        grid.set({x, 101 + (x < 130)}, std::nanf(""));
    }
    for (const bool solid : {false, true}) {
        TinMesh mesh = tiled_tin(grid, {.tolerance = 60}, 64);
        if (solid) mesh = solid_below(mesh, {199, 179}).top;
        const std::int64_t area = doubled_area(mesh);
        std::size_t border = 0, border_after = 0;
        if (!solid) {
            EXPECT_TRUE(sound(mesh, &border));
        }
        TinMending mending(mesh);
        std::size_t inside = 0;
        for (const glm::ivec2 p : some_samples(mesh, grid)) {
            const TinMesh now = mending.mesh(grid);
            inside += mending.insert(p, triangle_of(now, p));
            mending.take_changed();
        }
        EXPECT_GT(inside, 5u);
        const TinMesh mended = mending.mesh(grid);
        EXPECT_EQ(doubled_area(mended), area);
        if (solid) continue;  // whose holes touch in vertices of their own
        EXPECT_TRUE(sound(mended, &border_after));
        EXPECT_GE(border_after, border);
        EXPECT_EQ(brute_deviation(mended, grid).voids, brute_deviation(mesh, grid).voids);
    }
}

}  // namespace
}  // namespace planet
