#include "planet/mesh/segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <tuple>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/refine.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {
namespace {

using testing::BallTiles;
using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
using Triangle = std::array<Key, 3>;

double hills(const glm::dvec3& n) {
    return 3000 * std::sin(31 * n.x) * std::cos(17 * n.y + n.z);
}

Key key(const GridPosition& g) {
    return {g.x, g.y, g.z, g.low};
}

Triangle normalized(Key a, Key b, Key c) {
    Triangle t{a, b, c};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

std::vector<Triangle> triangles_of(const Segments& s) {
    std::vector<Triangle> list;
    for (const Segment& segment : s.segments()) {
        const auto* index = s.indices().data() + segment.first_index;
        const auto at = [&](std::uint32_t i) { return key(s.vertices()[segment.first_vertex + index[i]].position); };
        for (std::uint32_t i = 0; i + 2 < segment.index_count; ++i) {
            if (index[i] == index[i + 1] || index[i + 1] == index[i + 2] || index[i] == index[i + 2]) continue;
            list.push_back(i & 1 ? normalized(at(i + 1), at(i), at(i + 2)) : normalized(at(i), at(i + 1), at(i + 2)));
        }
    }
    std::sort(list.begin(), list.end());
    return list;
}

SegmentView view_at(double latitude, double longitude, double height, double K) {
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, normal_from_geodetic(latitude * degrees, longitude * degrees), {height}), K};
    view.culling.eye = view.test.eye;
    return view;
}

// Without culling the segments are exactly the closed mesh: same triangles, same bits, same winding.
TEST(Segments, AreTheClosedMeshBitForBit) {
    const BallTiles tiles(26, 0.001, hills);
    for (const auto& [latitude, longitude, height] :
         {std::tuple{40.0, -105.0, 2e4}, {90.0, 0.0, 1e4}, {0.0, 180.0, 5e5}, {-12.0, 90.0, 2e7}}) {
        const SegmentView view = view_at(latitude, longitude, height, 200);
        const TriangleMesh mesh = refine_planet(tiles, view.test);
        std::vector<Triangle> want;
        for (const auto& t : mesh.triangles)
            want.push_back(normalized(key(mesh.vertices[t[0]]), key(mesh.vertices[t[1]]), key(mesh.vertices[t[2]])));
        std::sort(want.begin(), want.end());
        Segments segments;
        segments.build(tiles, view);
        EXPECT_EQ(segments.leaf_count(), mesh.triangles.size());
        EXPECT_TRUE(triangles_of(segments) == want);
        EXPECT_GT(segments.segments().size(), 8u);
    }
}

TEST(Segments, DoNotDependOnThreads) {
    const BallTiles tiles(26, 0.001, hills);
    const SegmentView view = view_at(46, 8, 3e4, 300);
    Segments one, four;
    one.build(tiles, view, 1);
    four.build(tiles, view, 4);
    ASSERT_EQ(one.vertices().size(), four.vertices().size());
    EXPECT_EQ(std::memcmp(one.vertices().data(), four.vertices().data(), one.vertices().size_bytes()), 0);
    EXPECT_TRUE(std::equal(one.indices().begin(), one.indices().end(), four.indices().begin(), four.indices().end()));
}

// What a tile knows of the roots below must never say "leaf" where the tile below says "split": that would be a crack.
TEST(PlacedTile, BoundsOfChildrenPassWhateverTheChildPasses) {
    for (const double exaggeration : {1.0, 5.0}) {
        const BallTiles tiles(26, 0.001, hills, exaggeration);
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> unit(-1, 1);
        std::size_t split = 0, kept_out = 0;
        for (int i = 0; i < 400; ++i) {
            const PlacedTile& face = *tiles.tile(LocationCode::face_root(i & 7));
            const auto k = static_cast<unsigned>(random() % tile_cells);
            const PlacedTile& child = *face.child(tiles, k);
            const SplitRecord& s = child.split[1];
            const glm::dvec3 m(s.x, s.y, s.z);
            const glm::dvec3 away = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
            // Just inside the reach of the exact test, and far outside.
            SplitTest test{{}, 1000 * (1 + unit(random))};
            const double reach = static_cast<double>(s.radius) + test.K * static_cast<double>(s.deviation);
            test.eye = m + away * (reach * 0.9999999);
            ASSERT_TRUE(test(s));
            ASSERT_NE(face.child(tiles, k, test), nullptr);
            ++split;
            test.eye = m + away * (reach * 1.1 + 2e4);
            kept_out += face.child(tiles, k, test) == nullptr;
        }
        EXPECT_EQ(split, 400u);
        EXPECT_GT(kept_out, 350u);
    }
}

// u, v name the vertex's place on its patch: walking there from the patch's corners gives the same direction.
TEST(Segments, PatchCoordinatesLeadToTheVertex) {
    const BallTiles tiles(30, 0.001);  // a smooth ellipsoid: the grid position gives the direction back
    Segments segments;
    SegmentView view = view_at(40, -105, 2e4, 200);
    view.finest_patch_level = 20;  // a child tile's corner of the lattice lies above some roots' tiles, below others
    segments.build(tiles, view);
    std::size_t tested = 0, above = 0;
    for (const Segment& s : segments.segments()) {
        EXPECT_EQ(s.patch, diamond(s.root.ancestor(std::min(20, s.root.bisection_level()))));
        above += s.root.bisection_level() > 20;
        const Corners c = corners(s.patch), far = corners(neighbor(s.patch));
        const std::uint32_t end = s.first_index + s.index_count;
        for (std::uint32_t i = s.first_index; i < end; i += 7) {
            const SegmentVertex& v = segments.vertices()[s.first_vertex + segments.indices()[i]];
            const double u = v.u / 32768.0, w = v.v / 32768.0;
            ASSERT_LE(v.u, 32768);
            ASSERT_LE(v.v, 32768);
            // Piecewise linear over the two halves of the patch; exact at corners, close inside small patches.
            const glm::dvec3 n = u + w <= 1
                                     ? c.apex + u * (c.left - c.apex) + w * (c.right - c.apex)
                                     : far.apex + (1 - u) * (far.left - far.apex) + (1 - w) * (far.right - far.apex);
            const glm::dvec3 p = ecef_from_normal(wgs84, glm::normalize(n), {0});
            const double size = glm::distance(c.left, c.right) * 6.4e6;
            ASSERT_LT(glm::distance(p, ecef_from_grid(v.position)),
                      0.25 * size * std::min(1.0, size / 6.4e6) + 0.01 * size)
                << to_string(s.root) << " " << u << " " << w;
            ++tested;
        }
    }
    EXPECT_GT(tested, 1000u);
    EXPECT_GT(above, 10u);
}

// Culling never removes a triangle that the view shows, whatever is in front.
TEST(Segments, CullingKeepsEverythingInTheFrustumAboveTheHorizon) {
    const BallTiles tiles(20, 0.001, hills);
    for (const double height : {4e4, 1e5, 3e6, 3e7}) {
        SegmentView view = view_at(20, 50, height, 150);
        Segments all, culled;
        all.build(tiles, view);
        const glm::dvec3 ahead = glm::normalize(glm::dvec3(-0.3, -0.8, 0.2) - 0.9 * glm::normalize(view.test.eye));
        const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 0, 1))), up = glm::cross(right, ahead);
        const double c = std::cos(0.4), s = std::sin(0.4);
        view.culling.inward = {c * right + s * ahead, -c * right + s * ahead, c * up + s * ahead, -c * up + s * ahead};
        view.culling.occluder_radius = 6356752.0 - 3000 - 1;
        culled.build(tiles, view);
        const auto kept = triangles_of(culled);
        EXPECT_LE(kept.size(), all.leaf_count());
        std::size_t shown = 0;
        for (const Triangle& t : triangles_of(all)) {
            bool seen = false;
            for (const Key& k : t) {
                const auto [x, y, z, low] = k;
                const glm::dvec3 p = ecef_from_grid({x, y, z, low}), to = p - view.test.eye;
                bool inside = true;
                for (const auto& n : view.culling.inward) inside = inside && glm::dot(n, to) >= 0;
                // Hidden by the ball iff the segment from the eye to p enters it.
                const double along = std::clamp(-glm::dot(view.test.eye, to) / glm::dot(to, to), 0.0, 1.0);
                const bool clear = glm::length(view.test.eye + along * to) >= view.culling.occluder_radius;
                seen = seen || (inside && clear);
            }
            if (!seen) continue;
            ++shown;
            ASSERT_TRUE(std::binary_search(kept.begin(), kept.end(), t));
        }
        EXPECT_GT(shown, 0u) << height;
    }
}

}  // namespace
}  // namespace planet
