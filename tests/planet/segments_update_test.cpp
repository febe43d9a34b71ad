// Segments from frame to frame: the same as made anew, after any path.

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>

#include "ball_tiles.h"
#include "segments_witness.h"

namespace planet {
namespace {

using pedestrian::places;
using testing::beside;
using testing::Ground;
using testing::look;
using testing::Witness;

class SegmentsOverPlaces : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(, SegmentsOverPlaces, ::testing::Range<std::size_t>(0, std::size(places)),
                         [](const auto& p) { return places[p.param].name; });

// From 20,000 km down to 40 m.
TEST_P(SegmentsOverPlaces, AreTheSameAsMadeAnewWhileDiving) {
    for (const double exaggeration : {1.0, 0.0, 5.0}) {
        const Ground g(GetParam(), exaggeration);
        const double a = places[GetParam()].ellipsoid.a;
        SegmentView view;
        view.test.K = 150;
        Segments segments;
        Witness witness;
        const glm::dvec3 side = beside(g.centre);
        constexpr int frames = 64;
        for (int f = 0; f < frames; ++f) {
            const double height = 2e7 * std::pow(40 / 2e7, f / (frames - 1.0)), turn = 0.9 * std::sin(f * 0.2);
            const glm::dvec3 eye = g.centre * (a + 8000 * exaggeration + height);
            look(view, {eye, -g.centre + turn * side}, 0.99 * places[GetParam()].ellipsoid.b);
            segments.update(g.tiles, view, 1 + f % 2);
            ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, g.tiles, view));
        }
        EXPECT_GT(witness.seen(), 2000u);
        EXPECT_LT(witness.built(), 1.0);
    }
}

// Low over the place's middle (a pole, an E_i, ...) in small steps: most segments stay what they are.
TEST_P(SegmentsOverPlaces, AreTheSameAsMadeAnewWhileCrossing) {
    const Ground g(GetParam());
    const double a = places[GetParam()].ellipsoid.a;
    SegmentView view;
    view.test.K = 300;
    view.morph = true;
    Segments segments;
    Witness witness;
    const glm::dvec3 side = beside(g.centre);
    for (int f = 0; f < 60; ++f) {
        const double along = 100.0 * (f - 30);
        const glm::dvec3 eye = glm::normalize(g.centre * a + side * along) * (a + 12000 + 10 * std::cos(f));
        look(view, {eye, side - g.centre * (0.5 + 0.5 * std::sin(f * 0.37))}, 0.99 * places[GetParam()].ellipsoid.b);
        segments.update(g.tiles, view, 2);
        ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, g.tiles, view));
    }
    EXPECT_GT(witness.seen(), 2000u);
    EXPECT_LT(witness.built(), 0.5);
}

// Jumps, turns on the spot, other parameters, all mixed, with room for few leaves out of view.
TEST(SegmentsUpdate, IsTheSameAsMadeAnewAfterAnything) {
    const Ground plain(4), steep(4, 5);
    SegmentView view;
    view.kept_leaves = 2000;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    Segments segments;
    Witness witness;
    const TileSource* tiles = &plain.tiles;
    glm::dvec3 eye = plain.centre * (wgs84.a + 2e4);
    view.test.K = 200;
    for (int f = 0; f < 150; ++f) {
        const glm::dvec3 d(unit(random), unit(random), unit(random));
        switch (random() % 8) {
            case 0:
                eye = plain.centre * (wgs84.a + 2e4 + 1e6 * std::abs(d.x)) + d * 1e5;
                break;
            case 1:
                view.test.K = 100 * std::exp2(d.x);
                break;
            case 2:
                view.segment_angle = 0.1 * std::exp2(3 * d.x);
                break;
            case 3:
                view.segment_leaves = 1 + static_cast<int>(500 * d.x * d.x);
                break;
            case 4:
                tiles = tiles == &plain.tiles ? &steep.tiles : &plain.tiles;
                break;
            case 5:
                view.finest_patch_level = 8 + static_cast<int>(random() % 20);
                break;
            default:
                eye += d * std::exp2(8 * unit(random) + 4);
                break;
        }
        look(view, {eye, -plain.centre + 0.7 * glm::dvec3(unit(random), unit(random), unit(random))}, 6.3e6);
        segments.update(*tiles, view, 1 + f % 4);
        ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, *tiles, view, 1 + (f + 1) % 4));
        ASSERT_LE(segments.kept_leaves(), view.kept_leaves);
    }
    EXPECT_GT(witness.seen(), 2000u);
}

// Tiles that come and go under an eye that wanders: what may hold them is built anew, the rest kept.
TEST(SegmentsUpdate, FollowsTilesThatComeAndGo) {
    testing::BallTiles tiles(30, 0.002, [](const glm::dvec3& n) { return 2000 * std::sin(40 * n.x + 31 * n.y); });
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    const glm::dvec3 n = normal_from_geodetic(0.6, 0.4);
    SegmentView view;
    view.test.K = 250;
    view.test.eye = view.culling.eye = n * (wgs84.a + 2e4);
    Segments segments;
    Witness witness;
    std::set<std::uint64_t> used, away;
    for (int f = 0; f < 60; ++f) {
        if (f % 3 != 0) view.test.eye += glm::dvec3(unit(random), unit(random), unit(random)) * 300.0;
        segments.update(tiles, view);
        ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, tiles, view));
        for (const Segment& s : segments.segments())
            if (s.root.bisection_level() >= 24) used.insert(s.root.ancestor(24).bits());
        ASSERT_FALSE(used.empty());
        std::vector<LocationCode> changed;
        for (int k = 0; k < 3; ++k) {
            auto at = used.begin();
            std::advance(at, static_cast<std::ptrdiff_t>(random() % used.size()));
            changed.emplace_back(*at);
            const bool there = away.erase(*at) != 0;
            if (!there) away.insert(*at);
            tiles.set_there(LocationCode(*at), there);
        }
        const auto before = segments.hash();
        segments.invalidate(changed);
        EXPECT_EQ(segments.hash(), before);  // until the next update
    }
    EXPECT_LT(witness.built(), 0.7);
}

// Nothing moves: nothing is written. The eye moves by less than all slacks: the same. A turn only lists other segments.
TEST(SegmentsUpdate, WritesOnlyWhatChanges) {
    const Ground g(4);
    SegmentView view;
    view.test.K = 300;
    Segments segments;
    const glm::dvec3 eye = g.centre * (wgs84.a + 9000);
    look(view, {eye, -g.centre + beside(g.centre)}, 6.3e6);
    segments.update(g.tiles, view);
    const std::size_t all = segments.built();
    EXPECT_GE(all, segments.segments().size());
    ASSERT_EQ(segments.changed_vertices().size(), 1u);
    EXPECT_EQ(segments.changed_vertices()[0], (Range{0, static_cast<std::uint32_t>(segments.vertices().size())}));

    segments.update(g.tiles, view);
    EXPECT_EQ(segments.built(), 0u);
    EXPECT_TRUE(segments.changed_vertices().empty());

    const std::vector<SegmentVertex> before(segments.vertices().begin(), segments.vertices().end());
    look(view, {eye, -g.centre - beside(g.centre)}, 6.3e6);
    segments.update(g.tiles, view);
    look(view, {eye, -g.centre + beside(g.centre)}, 6.3e6);
    segments.update(g.tiles, view);
    EXPECT_EQ(segments.built(), 0u);

    // What is not said to have changed has not.
    for (int f = 1; f < 40; ++f) {
        std::vector<SegmentVertex> old(segments.vertices().begin(), segments.vertices().end());
        look(view, {eye + 3.0 * f * beside(g.centre), -g.centre + beside(g.centre)}, 6.3e6);
        segments.update(g.tiles, view);
        EXPECT_LT(segments.built(), all / 2);
        std::vector<bool> changed(segments.vertices().size());
        for (const Range& r : segments.changed_vertices()) {
            ASSERT_LE(r.first + r.count, segments.vertices().size());
            std::fill_n(changed.begin() + r.first, r.count, true);
        }
        for (const Segment& s : segments.segments())
            for (std::uint32_t v = s.first_vertex; v < s.first_vertex + s.vertex_count; ++v)
                if (!changed[v]) {
                    ASSERT_LT(v, old.size());
                    ASSERT_EQ(std::memcmp(&old[v], &segments.vertices()[v], sizeof(SegmentVertex)), 0);
                }
    }
}

}  // namespace
}  // namespace planet
