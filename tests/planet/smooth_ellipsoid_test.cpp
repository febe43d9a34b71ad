#include "planet/mesh/smooth_ellipsoid.h"

#include <gtest/gtest.h>

#include <random>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/surface_check.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {
namespace {

using testing::BallTiles;

TriangleMesh triangle_mesh(const SmoothEllipsoid& e) {
    TriangleMesh mesh;
    mesh.vertices.assign(e.vertices().begin(), e.vertices().end());
    mesh.strip.assign(e.strip().begin(), e.strip().end());
    for (std::size_t i = 0; i + 2 < mesh.strip.size(); ++i) {
        std::uint32_t a = mesh.strip[i], b = mesh.strip[i + 1];
        const std::uint32_t c = mesh.strip[i + 2];
        if (a == b || b == c || a == c) continue;
        if (i & 1) std::swap(a, b);
        mesh.triangles.push_back({a, b, c});
    }
    return mesh;
}

void expect_same(const SmoothEllipsoid& ball, const StripMesh& mesh) {
    ASSERT_TRUE(std::ranges::equal(ball.strip(), mesh.strip()));
    ASSERT_TRUE(std::ranges::equal(ball.vertices(), mesh.vertices()));
}

glm::dvec3 random_eye(std::mt19937_64& random, const Ellipsoid& e, double height) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const glm::dvec3 n = normal_from_geodetic(std::asin(unit(random)), std::numbers::pi * unit(random));
    return ecef_from_normal(e, n, {height});
}

TEST(SmoothEllipsoid, UniformMeshesAreThoseOfTheTiles) {
    SmoothEllipsoid ball(wgs84);
    for (int level = 0; level <= 14; ++level) {
        ball.refine_to_level(level);
        ASSERT_EQ(ball.triangles(), 8u << level);
        const SurfaceCheck c = check(triangle_mesh(ball));
        ASSERT_TRUE(c.closed()) << "level " << level << ": " << c.summary();
        ASSERT_EQ(c.triangles, 8u << level);
        if (level == 0) continue;
        StripMesh mesh;
        mesh.refine(BallTiles(level), {glm::dvec3(0), 1e30});
        expect_same(ball, mesh);
    }
}

TEST(SmoothEllipsoid, EqualsTheWalkOverTilesOfTheSameBounds) {
    std::mt19937_64 random(5);
    SmoothEllipsoid ball(wgs84);
    StripMesh mesh;
    for (const double roughness : {0.0, 0.001, 0.02}) {
        const BallTiles tiles(22, roughness);
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 eye = random_eye(random, wgs84, std::exp(5 + 0.3 * i));
            const double K = roughness > 0.01 ? 20 + i : 100 + 20 * i;
            mesh.refine(tiles, {eye, K});
            ball.refine(tiles.bounds(), eye, K);
            ASSERT_GT(ball.triangles(), 50u);
            ASSERT_NO_FATAL_FAILURE(expect_same(ball, mesh)) << "roughness " << roughness << ", view " << i;
        }
    }
}

// Seams, and eyes inside the planet, at its centre and on a vertex.
TEST(SmoothEllipsoid, IsClosedForEveryView) {
    std::mt19937_64 random(6);
    for (const Ellipsoid& e : {wgs84, moon, mars, ellipsoid("oblate", 6e6, 0.3)}) {
        SmoothEllipsoid ball(e);
        const auto bounds = smooth_bounds(e, 34, 0.002);
        std::vector<glm::dvec3> eyes = {{0, 0, 0},    {e.a, 0, 0},         {0, e.a + 2, 0}, {0, 0, e.b + 2},
                                        {0, 0, -e.b}, {-e.a, 1e-9, -1e-9}, {1e9, 1e9, 1e9}};
        for (int i = 0; i < 50; ++i) eyes.push_back(random_eye(random, e, std::exp(0.3 * i)));
        for (const glm::dvec3& eye : eyes) {
            ball.refine(bounds, eye, 60);
            const TriangleMesh mesh = triangle_mesh(ball);
            const SurfaceCheck c = check(mesh);
            ASSERT_TRUE(c.closed()) << e.name << " from " << eye.x << "," << eye.y << "," << eye.z << ": "
                                    << c.summary();
            ASSERT_EQ(mesh.triangles.size(), ball.triangles());
        }
    }
}

TEST(SmoothEllipsoid, KeepsNothingOfTheMeshBefore) {
    const auto bounds = smooth_bounds(moon, 30);
    const glm::dvec3 eye(0, moon.a + 500, 0);
    SmoothEllipsoid once(moon), again(moon);
    once.refine(bounds, eye, 300);
    again.refine_to_level(15);
    again.refine(bounds, eye, 300);
    EXPECT_TRUE(std::ranges::equal(once.strip(), again.strip()));
    EXPECT_TRUE(std::ranges::equal(once.vertices(), again.vertices()));
}

/// Walks all cells of a face and compares every sample with every ancestor's plane.
struct BoundsWalk {
    const Ellipsoid& e;
    const std::vector<LevelBounds>& bounds;
    std::vector<double> deviation{};

    void cell(const Corners& c, std::size_t level) {
        if (level == bounds.size()) return;
        const glm::dvec3 p = ecef_from_normal(e, c.left), q = ecef_from_normal(e, c.right),
                         s = ecef_from_normal(e, c.apex);
        const glm::dvec3 plane = glm::cross(q - p, s - p);
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; i + j <= 8; ++j) {
                const glm::dvec3 n =
                    glm::normalize(double(i) * c.left + double(j) * c.right + double(8 - i - j) * c.apex);
                const double t = glm::dot(p - ecef_from_normal(e, n), plane) / glm::dot(n, plane);
                deviation[level] = std::max(deviation[level], std::abs(t));
            }
        const glm::dvec3 m = split_vertex(c), place = ecef_from_normal(e, m);
        for (int i = 0; i < 2; ++i) {
            const Corners half = child_corners(c, m, i);
            const double step = glm::distance(place, ecef_from_normal(e, split_vertex(half)));
            const double below = level + 1 < bounds.size() ? bounds[level + 1].radius : 0;
            ASSERT_LE(step + below, bounds[level].radius) << "level " << level;
            ASSERT_LE(glm::distance(place, ecef_from_normal(e, half.left)), bounds[level].radius);
            cell(half, level + 1);
        }
    }
};

TEST(SmoothEllipsoid, BoundsHoldAndAreSaturated) {
    for (const Ellipsoid& e : {wgs84, sphere(), mars, ellipsoid("oblate", 6e6, 0.02)}) {
        const auto bounds = smooth_bounds(e, 12);
        BoundsWalk walk{e, bounds};
        walk.deviation.resize(bounds.size());
        for (const int face : {0, 5}) walk.cell(face_corners(face), 0);
        for (std::size_t level = 0; level < bounds.size(); ++level) {
            EXPECT_LE(walk.deviation[level], bounds[level].deviation) << e.name << " level " << level;
            EXPECT_GE(walk.deviation[level], 0.5 * bounds[level].deviation) << e.name << " level " << level;
            if (level > 0) {
                EXPECT_LE(bounds[level].deviation, bounds[level - 1].deviation);
            }
        }
    }
}

}  // namespace
}  // namespace planet
