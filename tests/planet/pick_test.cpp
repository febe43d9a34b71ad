// Rays against the drawn triangles.

#include <gtest/gtest.h>

#include "ground_stores.h"
#include "planet/mesh/pick.h"
#include "planet/mesh/refine.h"
#include "planet/streaming/store_tiles.h"
#include "planet/terrain/ground.h"

namespace planet {
namespace {

using testing::hills;

/// The first of all triangles, one after the other.
std::optional<double> slow_pick(const TriangleMesh& mesh, const glm::dvec3& o, const glm::dvec3& d) {
    std::optional<double> first;
    for (const auto& t : mesh.triangles) {
        const glm::dvec3 a = ecef_from_grid(mesh.vertices[t[0]]), b = ecef_from_grid(mesh.vertices[t[1]]),
                         c = ecef_from_grid(mesh.vertices[t[2]]);
        const glm::dvec3 n = glm::cross(b - a, c - a);
        const double at = glm::dot(a - o, n) / glm::dot(d, n);
        const glm::dvec3 p = o + at * d;
        const auto inside = [&](const glm::dvec3& u, const glm::dvec3& v) {
            return glm::dot(glm::cross(v - u, p - u), n) >= 0;
        };
        if (at >= 0 && (!first || at < *first) && inside(a, b) && inside(b, c) && inside(c, a)) first = at;
    }
    return first;
}

class PickTest : public ::testing::TestWithParam<double> {};

TEST_P(PickTest, MeetsTheFirstTriangleThatIsDrawn) {
    const StoreTiles tiles(hills().cache(), {wgs84, GetParam()});
    testing::PlacesInHills places(31);
    int hits = 0, misses = 0;
    for (int view = 0; view < 8; ++view) {
        const glm::dvec3 n = testing::normal_of(places.next());
        const glm::dvec3 eye = ecef_from_normal(wgs84, n, {6000 * GetParam() + std::exp2(8 + 1.8 * view)});
        const SplitTest test{eye, 300};
        const TriangleMesh mesh = refine_planet(tiles, test);
        for (int i = 0; i < 40; ++i) {
            const glm::dvec3 direction =
                glm::normalize(glm::dvec3(places.unit(), places.unit(), places.unit()) - 0.5 - 0.35 * n);
            const auto picked = pick(tiles, test, eye, 3.0 * direction);
            const auto expected = slow_pick(mesh, eye, 3.0 * direction);
            ASSERT_EQ(picked.has_value(), expected.has_value()) << view << " " << i;
            ++(picked ? hits : misses);
            if (!picked) continue;
            ASSERT_NEAR(picked->distance, *expected, 1e-6 + 1e-12 * *expected);
            ASSERT_LT(glm::length(eye + picked->distance * 3.0 * direction - picked->position), 1e-6);
            ASSERT_NE(std::find(mesh.cells.begin(), mesh.cells.end(), picked->cell), mesh.cells.end());
            // The triangle holds the place.
            const Corners c = corners(picked->cell);
            ASSERT_NEAR(picked->weights.x + picked->weights.y + picked->weights.z, 1, 1e-9);
            ASSERT_GE(std::min({picked->weights.x, picked->weights.y, picked->weights.z}), -1e-8);
            static_cast<void>(c);
        }
    }
    EXPECT_GT(hits, 100);
    EXPECT_GT(misses, 30);
}

// Exaggeration moves what is picked, and not the height that is told.
TEST_P(PickTest, TellsTheHeightThatIsNotExaggerated) {
    const StoreTiles tiles(hills().cache(), {wgs84, GetParam()});
    testing::PlacesInHills places(37);
    SurfaceCursor cursor = hills().cursor();
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 n = testing::normal_of(places.next());
        const glm::dvec3 eye = ecef_from_normal(wgs84, n, {60000});
        const auto picked = pick(tiles, {eye, 1e9}, eye, -n);  // the finest surface
        ASSERT_TRUE(picked);
        ASSERT_NEAR(picked->height, ground_at(cursor, n).height, 0.1 * GetParam());
    }
}

INSTANTIATE_TEST_SUITE_P(Exaggerations, PickTest, ::testing::Values(1.0, 5.0));

TEST(Pick, NeverSlipsBetweenTriangles) {
    const StoreTiles tiles(hills().cache(), {wgs84, 1});
    testing::PlacesInHills places(41);
    SurfaceCursor cursor = hills().cursor();
    for (int i = 0; i < 300; ++i) {
        cursor.seek(testing::normal_of(places.next()));
        const Corners c = corners(cursor.cell());
        for (const glm::dvec3& n : {c.left, c.apex, split_vertex(c)}) {
            const glm::dvec3 eye = ecef_from_normal(wgs84, n, {20000});
            ASSERT_TRUE(pick(tiles, {eye, 1e9}, eye, -n));
        }
    }
}

}  // namespace
}  // namespace planet
