// Segments whose next view was prepared for: the same as made anew, and as they were until then.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "ball_tiles.h"
#include "segments_witness.h"

namespace planet {
namespace {

using pedestrian::places;
using testing::beside;
using testing::Ground;
using testing::look;
using testing::Witness;

/// What a GPU has that is sent only what has changed.
class Follower {
  public:
    void follow(const Segments& s) {
        copy(vertices_, s.vertices(), s.changed_vertices());
        copy(indices_, s.indices(), s.changed_indices());
    }
    void expect_has(const Segments& segments) const {
        for (const Segment& s : segments.segments()) {
            ASSERT_EQ(std::memcmp(&vertices_[s.first_vertex], &segments.vertices()[s.first_vertex],
                                  s.vertex_count * sizeof(SegmentVertex)),
                      0);
            ASSERT_TRUE(std::equal(&indices_[s.first_index], &indices_[s.first_index] + s.index_count,
                                   &segments.indices()[s.first_index]));
        }
    }

  private:
    template <class T>
    static void copy(std::vector<T>& to, std::span<const T> from, std::span<const Range> changed) {
        to.resize(std::max(to.size(), from.size()));
        for (const Range& r : changed) {
            ASSERT_LE(r.first + r.count, from.size());
            std::copy_n(from.begin() + r.first, r.count, to.begin() + r.first);
        }
    }
    std::vector<SegmentVertex> vertices_;
    std::vector<std::uint32_t> indices_;
};

/// From 20,000 km down to 40 m, turning.
SegmentView diving(const Ground& g, int frame, int frames) {
    SegmentView view;
    view.test.K = 150;
    const double height = 2e7 * std::pow(40 / 2e7, frame / (frames - 1.0)), turn = 0.9 * std::sin(frame * 0.2);
    look(view, {g.centre * (wgs84.a + 8000 + height), -g.centre + turn * beside(g.centre)}, 0.99 * wgs84.b);
    return view;
}

// The view to come is known, nearly known, or quite another; while it is prepared for, what is there is read.
TEST(SegmentsPrepare, IsTheSameAsMadeAnewWhateverWasPreparedFor) {
    const Ground g(4);
    constexpr int frames = 96;
    Segments segments;
    Witness witness;
    Follower follower;
    for (int f = 0; f < frames; ++f) {
        const SegmentView view = diving(g, f, frames);
        segments.update(g.tiles, view, 2);
        follower.follow(segments);
        ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, g.tiles, view));
        ASSERT_NO_FATAL_FAILURE(follower.expect_has(segments));
        const std::uint64_t hash = segments.hash();
        std::thread beside_reading([&] {
            const int next[] = {f + 1, f + 2, frames - 1 - f, f};
            SegmentView expected = diving(g, next[f % 4], frames);
            if (f % 3 == 1) expected.test.eye += 20.0 * g.centre;
            segments.prepare(g.tiles, expected, 1 + f % 2);
            if (f % 5 == 0) segments.prepare(g.tiles, diving(g, f / 2, frames));
        });
        std::uint64_t meanwhile = segments.hash();
        beside_reading.join();
        ASSERT_EQ(meanwhile, hash) << f;
        ASSERT_EQ(segments.hash(), hash) << f;
    }
}

// What was prepared for is there: the update looks at no tile, which could be gone, but says what is new.
TEST(SegmentsPrepare, LeavesNothingToBuildForTheViewItself) {
    testing::BallTiles tiles(30, 0.002, [](const glm::dvec3& n) { return 2000 * std::sin(40 * n.x + 31 * n.y); });
    const glm::dvec3 n = normal_from_geodetic(0.6, 0.4);
    const auto view_at = [&](int frame) {
        SegmentView view;
        view.test.K = 250;
        view.test.eye = view.culling.eye = n * (wgs84.a + 2e4 - 300.0 * frame);
        return view;
    };
    const auto set_fine_tiles = [&](const Segments& segments, bool there) {
        for (const Segment& s : segments.segments())
            if (s.root.bisection_level() >= 24) tiles.set_there(s.root.ancestor(24), there);
    };
    Segments segments, unprepared;
    segments.update(tiles, view_at(0));
    unprepared.update(tiles, view_at(0));
    std::size_t built = 0;
    for (int f = 1; f < 20; ++f) {
        unprepared.update(tiles, view_at(f));
        segments.prepare(tiles, view_at(f));
        set_fine_tiles(unprepared, false);
        segments.update(tiles, view_at(f));
        set_fine_tiles(unprepared, true);
        ASSERT_EQ(segments.hash(), unprepared.hash()) << f;
        EXPECT_EQ(segments.built(), unprepared.built());
        EXPECT_EQ(segments.ratio_max(), unprepared.ratio_max());
        built += segments.built();
    }
    EXPECT_GT(built, 200u);
}

TEST(SegmentsPrepare, ForAViewThatDiffersInMoreThanTheEyeDoesNothing) {
    const Ground g(4);
    Segments segments;
    Witness witness;
    segments.prepare(g.tiles, diving(g, 50, 96));
    EXPECT_TRUE(segments.segments().empty());
    SegmentView view = diving(g, 50, 96);
    segments.update(g.tiles, view);
    segments.prepare(g.tiles, diving(g, 51, 96));
    view.test.K *= 1.1;
    segments.update(g.tiles, view);
    witness.expect_equal(segments, g.tiles, view);
    segments.prepare(g.tiles, diving(g, 51, 96));
    segments.update(g.tiles, view);
    EXPECT_EQ(segments.built(), 0u);
    witness.expect_equal(segments, g.tiles, view);
}

// Tiles come and go before and after the preparation.
TEST(SegmentsPrepare, FollowsTilesThatComeAndGo) {
    testing::BallTiles tiles(30, 0.002, [](const glm::dvec3& n) { return 2000 * std::sin(40 * n.x + 31 * n.y); });
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1, 1);
    SegmentView view;
    view.test.K = 250;
    view.test.eye = view.culling.eye = normal_from_geodetic(0.6, 0.4) * (wgs84.a + 2e4);
    Segments segments;
    Witness witness;
    Follower follower;
    std::set<std::uint64_t> used, away;
    const auto change_tiles = [&] {
        std::vector<LocationCode> changed;
        for (int k = 0; k < 2 && !used.empty(); ++k) {
            auto at = used.begin();
            std::advance(at, static_cast<std::ptrdiff_t>(random() % used.size()));
            changed.emplace_back(*at);
            const bool there = away.erase(*at) != 0;
            if (!there) away.insert(*at);
            tiles.set_there(LocationCode(*at), there);
        }
        segments.invalidate(changed);
    };
    for (int f = 0; f < 60; ++f) {
        segments.update(tiles, view);
        follower.follow(segments);
        ASSERT_NO_FATAL_FAILURE(witness.expect_equal(segments, tiles, view));
        ASSERT_NO_FATAL_FAILURE(follower.expect_has(segments));
        for (const Segment& s : segments.segments())
            if (s.root.bisection_level() >= 24) used.insert(s.root.ancestor(24).bits());
        if (f % 3 != 0) view.test.eye += glm::dvec3(unit(random), unit(random), unit(random)) * 300.0;
        if (f % 2 == 0) change_tiles();
        SegmentView expected = view;
        if (f % 4 < 2) expected.test.eye += glm::dvec3(unit(random), unit(random), unit(random)) * 10.0;
        segments.prepare(tiles, expected);
        if (f % 5 < 3) change_tiles();
    }
    EXPECT_LT(witness.built(), 1.0);
}

}  // namespace
}  // namespace planet
