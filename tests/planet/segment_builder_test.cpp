#include "planet/mesh/segment_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <tuple>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/segments.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {
namespace {

using testing::BallTiles;
using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;

Key key(const GridPosition& g) {
    return {g.x, g.y, g.z, g.low};
}

double hills(const glm::dvec3& n) {
    return 3000 * std::sin(31 * n.x) * std::cos(17 * n.y + n.z);
}

int face_of(const glm::dvec3& n) {
    return (n.z < 0 ? 4 : 0) + (n.y >= 0 ? (n.x >= 0 ? 0 : 1) : (n.x < 0 ? 2 : 3));
}

struct Built {
    SegmentBuilder builder;
    std::vector<BuiltSegment> segments;

    Built(const TileSource& tiles, const SegmentView& view, const PlacedCell& cell) {
        builder.begin(tiles, view);
        builder.build(cell, cell.code(), segments);
    }
    std::vector<std::uint8_t> levels(const BuiltSegment& s) const {
        const auto all = builder.leaf_levels().subspan(s.first_leaf, s.leaves);
        return {all.begin(), all.end()};
    }
};

// A segment's leaves are known by their levels, in their order. Within the slack they stay; a little beyond, in the worst
// direction, they do not.
TEST(SegmentBuilder, SlackIsHowFarTheEyeMayMove) {
    for (const double exaggeration : {1.0, 5.0}) {
        const BallTiles tiles(24, 0.003, hills, exaggeration);
        std::mt19937_64 random(17);
        std::normal_distribution<double> normal;
        const auto direction = [&] {
            return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        };
        const glm::dvec3 above[] = {direction(), direction()};
        int changed = 0;
        for (int round = 0; round < 16; ++round) {
            SegmentView view;
            view.segment_leaves = 200;
            view.test.K = 100;
            view.test.eye = above[static_cast<std::size_t>(round % 2)] *
                            (wgs84.a + 16000 * exaggeration + 1e4 * std::exp2(8 * (round % 9) / 9.0));
            const glm::dvec3 below = glm::normalize(view.test.eye + 1e5 * direction());
            const PlacedCell face{tiles.tile(LocationCode::face_root(face_of(below))), 1};
            const Built at(tiles, view, face);
            ASSERT_GT(at.segments.size(), 5u);
            const BuiltSegment& s = *std::min_element(at.segments.begin(), at.segments.end(),
                                                      [&](const BuiltSegment& a, const BuiltSegment& b) {
                                                          return glm::distance(a.sphere.centre, view.test.eye) <
                                                                 glm::distance(b.sphere.centre, view.test.eye);
                                                      });
            ASSERT_LT(s.slack, 1e6);
            bool changes = false;
            for (int k = 0; k < 24; ++k) {
                // Towards and away from what is near is where most tests change.
                const glm::dvec3 d = k < 8 ? direction()
                                           : (k & 1 ? 1.0 : -1.0) * glm::normalize(s.sphere.centre - view.test.eye +
                                                                                   direction() * s.sphere.radius);
                for (const double part : {0.9999999, 1.2}) {
                    SegmentView moved = view;
                    moved.test.eye += d * (s.slack * part);
                    moved.segment_leaves = 1 << 20;
                    const Built there(tiles, moved, s.root);
                    ASSERT_EQ(there.segments.size(), 1u);
                    const bool same = there.levels(there.segments[0]) == at.levels(s);
                    if (part < 1)
                        ASSERT_TRUE(same) << s.slack;
                    else
                        changes = changes || !same;
                }
            }
            changed += changes;
        }
        EXPECT_GT(changed, 8);
    }
}

TEST(SegmentBuilder, SegmentsAreTheLargestCellsOfSoManyLeaves) {
    const BallTiles tiles(24, 0.003, hills);
    SegmentView view;
    view.test = {normal_from_geodetic(0.5, 0.5) * 6.5e6, 100};
    const PlacedCell face{tiles.tile(LocationCode::face_root(0)), 1};
    std::size_t leaves = 0;
    for (const int limit : {1, 2, 7, 64, 512, 1 << 20}) {
        view.segment_leaves = limit;
        const Built b(tiles, view, face);
        std::map<std::uint64_t, std::uint32_t> count;  // by cell, of all cells above segments as well
        std::size_t sum = 0;
        std::uint64_t end = face.code().first_at(max_bisection_level);
        for (const BuiltSegment& s : b.segments) {
            ASSERT_EQ(s.cell.first_at(max_bisection_level), end);
            end = s.cell.end_at(max_bisection_level);
            ASSERT_LE(s.leaves, static_cast<std::uint32_t>(limit));
            sum += s.leaves;
            for (LocationCode c = s.cell; c != face.code(); c = c.parent()) count[c.parent().bits()] += s.leaves;
        }
        EXPECT_EQ(end, face.code().end_at(max_bisection_level));
        for (const auto& [cell, n] : count) ASSERT_GT(n, static_cast<std::uint32_t>(limit));
        if (leaves == 0) leaves = sum;
        EXPECT_EQ(sum, leaves);
    }
    EXPECT_GT(leaves, 2000u);
}

/// Where a vertex belongs and what it splits, by the pedestrian way down from a face.
struct Origin {
    GridPosition a, b;
    int level = -1;  ///< of its diamond; -1: a corner of a face
};

class Origins {
  public:
    explicit Origins(double exaggeration) { placement_.exaggeration = exaggeration; }

    GridPosition place(const glm::dvec3& n) const {
        return grid_from_ecef(placement_.ecef(n, static_cast<double>(static_cast<float>(hills(n))), {}));
    }
    /// Takes down the three corners of a cell.
    void add(LocationCode cell) {
        Corners c = face_corners(cell.face());
        for (const glm::dvec3& n : {c.left, c.right, c.apex}) of.try_emplace(key(place(n)));
        for (int level = 0; level < cell.bisection_level(); ++level) {
            const glm::dvec3 m = split_vertex(c);
            of.try_emplace(key(place(m)), Origin{place(c.left), place(c.right), level});
            c = child_corners(c, m, static_cast<int>(cell.bits() >> (cell.bisection_level() - 1 - level) & 1));
        }
    }
    std::map<Key, Origin> of;

  private:
    Placement placement_;
};

TEST(SegmentBuilder, MorphsLeadToTheMiddleOfTheSideThatIsSplit) {
    for (const double exaggeration : {1.0, 3.0}) {
        const BallTiles tiles(26, 0.001, hills, exaggeration);
        SegmentView view;
        view.morph = true;
        view.segment_leaves = 100;
        view.test = {ecef_from_normal(wgs84, normal_from_geodetic(0.4, 1.2), {2e4}), 120};
        Segments segments;
        segments.build(tiles, view);
        ASSERT_EQ(segments.morphs().size(), segments.vertices().size());
        Origins origins(exaggeration);
        for (const TriangleMesh mesh = refine_planet(tiles, view.test); const LocationCode cell : mesh.cells)
            origins.add(cell);
        std::map<Key, MorphVertex> morph;
        std::size_t borders = 0, corners = 0;
        const auto bounds = tiles.bounds();
        for (const Segment& s : segments.segments())
            for (std::uint32_t v = s.first_vertex; v < s.first_vertex + s.vertex_count; ++v) {
                const GridPosition& at = segments.vertices()[v].position;
                const MorphVertex& m = segments.morphs()[v];
                const auto [found, is_new] = morph.try_emplace(key(at), m);
                if (!is_new) {  // the same bits in every segment
                    ASSERT_EQ(std::memcmp(&found->second, &m, sizeof m), 0);
                    ++borders;
                    continue;
                }
                const auto origin = origins.of.find(key(at));
                ASSERT_NE(origin, origins.of.end());
                const auto& [a, b, level] = origin->second;
                if (level < 0) {
                    ASSERT_EQ(m.x, 0);
                    ASSERT_EQ(m.radius, 0);
                    ++corners;
                    continue;
                }
                const glm::dvec3 middle = 0.5 * (ecef_from_grid(a) + ecef_from_grid(b));
                const glm::dvec3 weight_0 = ecef_from_grid(at) + glm::dvec3(m.x, m.y, m.z);
                ASSERT_LE(glm::distance(weight_0, middle), 1e-6 * (1 + glm::distance(middle, ecef_from_grid(at))));
                const auto& bound = bounds[static_cast<std::size_t>(level)];
                ASSERT_GE(static_cast<double>(m.deviation), bound.deviation);
                if (exaggeration == 1) {
                    ASSERT_EQ(static_cast<double>(m.deviation), bound.deviation);
                }
                ASSERT_GE(static_cast<double>(m.radius), bound.radius);
                // It is there: its split test passes, to within the rounding of the record.
                const double reach = static_cast<double>(m.radius) + view.test.K * static_cast<double>(m.deviation);
                ASSERT_LT(glm::distance(view.test.eye, ecef_from_grid(at)), reach + 1);
            }
        EXPECT_GT(borders, 1000u);
        EXPECT_EQ(corners, 6u);
    }
}

}  // namespace
}  // namespace planet
