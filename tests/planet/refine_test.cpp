#include <gtest/gtest.h>

#include <random>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/surface_check.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {
namespace {

using testing::BallTiles;

double bumps(const glm::dvec3& n) {
    return 4000 * std::sin(40 * n.x) * std::cos(33 * n.y) * std::sin(27 * n.z + 1);
}

TEST(TileLayout, AgreesWithTheLocationCode) {
    const TileLayout& t = tile_layout();
    EXPECT_EQ(t.vertex_count[12], tile_vertices);
    EXPECT_EQ(t.vertex_count[1], 4);
    for (const int face : {0, 3, 5}) {
        const auto normals = tile_normals(LocationCode::face_root(face), tile_levels);
        for (unsigned i = 1; i < 2 * tile_cells; ++i) {
            const int level = static_cast<int>(std::bit_width(i)) - 1;
            const auto cell = LocationCode::from_path(face, level, i ^ 1u << level);
            const Corners c = corners(cell);
            ASSERT_EQ(normals[t.corners[i][0]], c.left);
            ASSERT_EQ(normals[t.corners[i][1]], c.right);
            ASSERT_EQ(normals[t.corners[i][2]], c.apex);
            if (i >= tile_cells) continue;
            ASSERT_EQ(normals[t.split_vertex[i]], split_vertex(c));
            ASSERT_LT(t.split_vertex[i], t.vertex_count[static_cast<std::size_t>(level + 1)]);
            const LocationCode n = neighbor(cell);
            if (t.split_neighbor[i] != 0) {
                ASSERT_EQ(n.face(), face);
                ASSERT_EQ(n.path() | 1u << level, t.split_neighbor[i]);
            } else {
                ASSERT_NE(n.face(), face);
            }
        }
    }
}

TEST(Grid, RoundsToTheNearestUnitAndBack) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> coordinate(-grid_limit_m, grid_limit_m);
    for (int i = 0; i < 200000; ++i) {
        const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
        const GridPosition g = grid_from_ecef(p);
        const glm::dvec3 q = ecef_from_grid(g);
        for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(p[k] - q[k]), grid_rounding_m);
        ASSERT_EQ(grid_from_ecef(q), g);
    }
    for (const double v : {0.0, -0.0, grid_limit_m, -grid_limit_m, -grid_unit_m, 1.0 / 256, -1.0 / 256})
        EXPECT_EQ(ecef_from_grid(grid_from_ecef({v, v, v})), glm::dvec3(v));
}

TEST(Grid, ShaderArithmeticRoundsOnce) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> coordinate(-7e6, 7e6), far(-5.6e7, 5.6e7), near(-50, 50);
    for (int i = 0; i < 300000; ++i) {
        const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
        const glm::dvec3 e = i & 1 ? glm::dvec3(far(random), far(random), far(random)) : p + glm::dvec3(near(random));
        const GridEye eye = grid_eye(e);
        const GridPosition g = grid_from_ecef(p);
        const glm::dvec3 exact = ecef_from_grid(g) - ecef_from_grid_eye(eye);
        ASSERT_EQ(relative_from_grid(g, eye), glm::vec3(exact));  // correctly rounded, every coordinate
    }
}

TEST(RefinePlanet, UniformMeshesAreClosedAndTheirStripIsShort) {
    for (int level = 0; level <= 13; ++level) {
        BallTiles tiles(level == 0 ? 1 : level);
        // A huge K splits whatever can be split; level 0 is the octahedron itself.
        const SplitTest all{glm::dvec3(0), 1e30}, none{glm::dvec3(1e12, 0, 0), 0};
        const TriangleMesh mesh = refine_planet(tiles, level == 0 ? none : all);
        ASSERT_EQ(mesh.triangles.size(), level == 0 ? 8u : 8u << level);
        const SurfaceCheck c = check(mesh);
        EXPECT_TRUE(c.closed()) << "level " << level << ": " << c.summary();
        if (level >= 8) {
            EXPECT_LE(static_cast<double>(mesh.strip.size()),
                      1.01 * 5 / 3 * static_cast<double>(mesh.triangles.size()));
        }
    }
}

struct NamedView {
    const char* name;
    double latitude, longitude;
};

void expect_closed(const TileSource& tiles, double latitude, double longitude, double height, double K) {
    const glm::dvec3 n = normal_from_geodetic(latitude * degrees, longitude * degrees);
    const glm::dvec3 eye = ecef_from_normal(wgs84, n, {height});
    const TriangleMesh mesh = refine_planet(tiles, {eye, K});
    const SurfaceCheck c = check(mesh);
    ASSERT_TRUE(c.closed()) << latitude << "," << longitude << " at " << height << " m: " << c.summary();
    ASSERT_GT(c.triangles, 8u);
}

TEST(RefinePlanet, IsClosedForViewsAtEverySeam) {
    const BallTiles tiles(26, 0.0005, bumps);
    const NamedView seams[] = {{"north pole", 90, 0},
                               {"south pole", -90, 0},
                               {"antimeridian", 12, 180},
                               {"antimeridian", -40, -180},
                               {"E0", 0, 0},
                               {"E1", 0, 90},
                               {"E2", 0, 180},
                               {"E3", 0, -90},
                               {"face side", 45, 90},
                               {"equator", 0, 45},
                               {"near the pole", 89.9999, 33},
                               {"near E1", 0.0001, 89.9999}};
    for (const NamedView& v : seams)
        for (const double height : {2.0, 3000.0, 4e5, 2e7}) expect_closed(tiles, v.latitude, v.longitude, height, 120);
}

TEST(RefinePlanet, IsClosedForRandomViews) {
    const BallTiles tiles(18, 0.0005, bumps);
    const BallTiles high(18, 0.0005, bumps, 4.0);
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 200; ++i) {
        const double latitude = std::asin(unit(random)) / degrees, longitude = 180 * unit(random);
        const double height = std::exp(8.5 + 8.5 * unit(random));
        expect_closed(i % 4 == 0 ? high : tiles, latitude, longitude, height, 300 + 250 * unit(random));
    }
}

}  // namespace
}  // namespace planet
