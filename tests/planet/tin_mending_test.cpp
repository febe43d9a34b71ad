// Samples that go into TINs as they are: only what is around them changes.

#include "planet/tin/tin_mending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "planet/tin/delaunay.h"
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

// Puts samples in one by one, each into the triangle that holds it. @return how many
std::size_t mend_each(TinMesh& mesh, const HeightGrid& grid, const std::vector<glm::ivec2>& samples) {
    std::size_t inserted = 0;
    for (const glm::ivec2 p : samples) {
        const FarTriangle far{triangle_of(mesh, p), p, 0};
        inserted += mend(mesh, grid, {&far, 1}).inserted;
    }
    return inserted;
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

// A sample within a triangle, on none of its sides.
std::optional<glm::ivec2> inner_sample(const TinMesh& mesh, std::uint32_t triangle) {
    const auto [a, b, c] = mesh.triangles[triangle];
    const glm::ivec2 p = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    for (const auto& [u, v] : {std::pair{a, b}, {b, c}, {c, a}})
        if (orientation(mesh.vertices[u], mesh.vertices[v], p) <= 0) return std::nullopt;
    return p;
}

// Sides that Delaunay's rule would not have.
std::size_t doubted_sides(const TinMesh& mesh) {
    const Delaunay linked(mesh.vertices, mesh.triangles);
    std::size_t sides = 0;
    for (Delaunay::Index e = 0; e < 3 * linked.triangle_slots(); ++e) sides += linked.constrained(e);
    return sides / 2;
}

TEST(TinMending, ChangesOnlyWhatIsAroundASample) {
    const HeightGrid grid = rough_grid(400, 300);
    const TinMesh mesh = tiled_tin(grid, {.tolerance = 40}, 64);
    TinMesh mended = mesh;
    EXPECT_TRUE(mend(mended, grid, {}).changed.empty());
    EXPECT_EQ(mended.vertices, mesh.vertices);
    EXPECT_EQ(mended.triangles, mesh.triangles);
    const std::vector<glm::ivec2> samples = some_samples(mesh, grid);
    ASSERT_GT(samples.size(), 50u);
    for (const glm::ivec2 p : samples) {
        const TinMesh before = mended;
        const FarTriangle far{triangle_of(before, p), p, 0};
        const MendedTin done = mend(mended, grid, {&far, 1});
        ASSERT_EQ(done.inserted, 1u);
        EXPECT_TRUE(std::ranges::is_sorted(done.changed));
        EXPECT_LT(done.changed.size(), 60u);
        EXPECT_TRUE(has_vertex(mended, p));
        for (std::uint32_t t = 0; t < mended.triangles.size(); ++t) {
            const bool known = t < before.triangles.size() && corners(before, t) == corners(mended, t);
            EXPECT_EQ(known, !std::ranges::binary_search(done.changed, t));
        }
    }
    EXPECT_TRUE(sound(mended));
    EXPECT_EQ(doubled_area(mended), 2 * 399 * 299);
    EXPECT_EQ(mended.vertices.size(), mesh.vertices.size() + samples.size());
    for (std::size_t v = 0; v < mended.vertices.size(); ++v) EXPECT_EQ(mended.height[v], grid.at(mended.vertices[v]));
}

// The cavity of a sample seldom reaches beyond what is linked: by Delaunay's rule all the same.
TEST(TinMending, KeepsATriangulationDelaunay) {
    const HeightGrid grid = rough_grid(300, 300);
    TinMesh mended = make_tin(grid, {.tolerance = 60, .max_triangles = 20000}).mesh;  // as one
    const std::size_t before = doubted_sides(mended);
    EXPECT_EQ(before, 0u);
    EXPECT_GT(mend_each(mended, grid, some_samples(mended, grid)), 50u);
    EXPECT_EQ(doubted_sides(mended), 0u);
}

// More than are put in at a time, all at once: every triangle has a sample, and few are left out.
TEST(TinMending, TakesManySamples) {
    const HeightGrid grid = rough_grid(500, 400);
    TinMesh mesh = tiled_tin(grid, {.tolerance = 30}, 64);
    std::vector<FarTriangle> due;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (const auto inner = inner_sample(mesh, t)) due.push_back({t, *inner, 0});
    ASSERT_GT(due.size(), 3000u);
    const TinMesh before = mesh;
    const MendedTin done = mend(mesh, grid, due);
    EXPECT_GT(4 * done.inserted, due.size());
    EXPECT_LT(done.inserted, due.size()) << "none is put into a triangle that has changed";
    EXPECT_EQ(mesh.vertices.size(), before.vertices.size() + done.inserted);
    EXPECT_EQ(mesh.triangles.size(), before.triangles.size() + 2 * done.inserted);
    EXPECT_TRUE(sound(mesh));
    EXPECT_EQ(doubled_area(mesh), 2 * 499 * 399);
    EXPECT_TRUE(std::ranges::is_sorted(done.changed));
    EXPECT_EQ(std::ranges::adjacent_find(done.changed), done.changed.end());
}

TEST(TinMending, LeavesATriangleThatHasChangedToBeMeasured) {
    const HeightGrid grid = rough_grid(40, 30);
    TinMesh mesh = tiled_tin(grid, {.tolerance = 1e6}, 64);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    const std::uint32_t t = triangle_of(mesh, {30, 10});
    const std::array<FarTriangle, 2> both{{{t, {30, 10}, 0}, {t, {31, 11}, 0}}};
    EXPECT_EQ(mend(mesh, grid, both).inserted, 1u);
    EXPECT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mend_each(mesh, grid, {{31, 11}}), 1u);
}

// A line stays although no circle would have it, divided where a sample on it goes in.
TEST(TinMending, KeepsWhatFeaturesHold) {
    const HeightGrid grid = rough_grid(300, 290);
    TinMesh mesh = make_tin(grid, {.tolerance = 150, .features = {{}, {{{3, 3}, {283, 143}}}}}).mesh;
    ASSERT_FALSE(mesh.held_sides.empty());
    for (int x = 9; x < 280; x += 6)
        for (const int off : {-1, 0, 1}) {
            const glm::ivec2 p(x, 3 + (x - 3) / 2 + off);
            if (!has_vertex(mesh, p)) mend_each(mesh, grid, {p});
        }
    EXPECT_TRUE(sound(mesh));
    std::vector<glm::ivec2> on_line;
    for (const glm::ivec2 p : mesh.vertices)
        if (orientation({3, 3}, {283, 143}, p) == 0 && p.x >= 3 && p.x <= 283) on_line.push_back(p);
    std::ranges::sort(on_line, {}, [](glm::ivec2 p) { return p.x; });
    EXPECT_GT(on_line.size(), 40u);
    for (std::size_t i = 1; i < on_line.size(); ++i) EXPECT_TRUE(has_side(mesh, on_line[i - 1], on_line[i]));
    EXPECT_EQ(mesh.held_sides.size() + 1, on_line.size()) << "held still";
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
        const std::size_t voids = brute_deviation(mesh, grid).voids;
        EXPECT_GT(mend_each(mesh, grid, some_samples(mesh, grid)), 5u);
        EXPECT_EQ(doubled_area(mesh), area);
        if (solid) continue;  // whose holes touch in vertices of their own
        EXPECT_TRUE(sound(mesh, &border_after));
        EXPECT_GE(border_after, border);
        EXPECT_EQ(brute_deviation(mesh, grid).voids, voids);
    }
}

}  // namespace
}  // namespace planet
