// The mesh of the next view, made while one is drawn: the same as if it had not been, with tiles that come meanwhile.

#include "planet/streaming/mesh_ahead.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "patchy_store.h"
#include "planet/mesh/surface_check.h"
#include "planet/streaming/store_tiles.h"

namespace planet {
namespace {

using testing::crack_in;
using testing::narrow;
using testing::patchy_store;
using testing::view_from;

constexpr int frames = 90;

/// Down to a patch, drifting.
SegmentView flown(int frame) {
    const double height = 2e7 * std::pow(2000 / 2e7, frame / (frames - 1.0));
    const glm::dvec3 towards =
        testing::PatchyField::patches[1].cap.centre + 2e-8 * height * glm::dvec3(0.3, std::sin(0.1 * frame), -0.2);
    return narrow(view_from(towards, height, 300));
}

std::uint64_t hash_made_anew(const TileSource& tiles, const SegmentView& view) {
    Segments segments;
    segments.build(tiles, view);
    return segments.hash();
}

enum class Expected { guessed, known, wrong };

void fly(Expected expected, std::size_t memory) {
    const TileCache cache(patchy_store(), memory);
    const StoreTiles all(cache, Placement{});
    ResidentTiles tiles(cache, Placement{}, 1);
    Segments segments;
    MeshAhead ahead(tiles, segments);
    for (int f = 0; f < frames; ++f) {
        const SegmentView view = flown(f);
        EXPECT_EQ(ahead.finish(), f > 0);
        segments.invalidate(tiles.update(view, nullptr, f % 3 == 0 ? 100 : 0));
        segments.update(tiles, view, 2);
        ASSERT_EQ(segments.hash(), hash_made_anew(tiles, view)) << f;
        if (f % 10 == 0) {
            ASSERT_EQ(crack_in(tiles, view.test), "") << f;
        }
        const std::uint64_t drawn = segments.hash();
        const SegmentView next = expected == Expected::known     ? flown(f + 1)
                                 : expected == Expected::guessed ? view_after(flown(std::max(f - 1, 0)), view)
                                                                 : flown((f * 37) % frames);
        ahead.begin(next, flown(f + 5), 100, 1);
        ASSERT_EQ(segments.hash(), drawn) << f;
    }
    EXPECT_TRUE(ahead.finish());
    EXPECT_FALSE(ahead.finish());
    EXPECT_GT(ahead.seconds(), 0);
    const SegmentView last = flown(frames - 1);
    segments.invalidate(tiles.settle(last));
    segments.update(tiles, last);
    EXPECT_EQ(segments.hash(), hash_made_anew(all, last));
}

TEST(MeshAhead, ChangesNothingWhereTheMotionIsGuessed) {
    fly(Expected::guessed, std::size_t{1} << 30);
}

TEST(MeshAhead, ChangesNothingWhereTheViewIsKnown) {
    fly(Expected::known, std::size_t{1} << 30);
}

TEST(MeshAhead, ChangesNothingWhereAllWasExpectedWrongly) {
    fly(Expected::wrong, std::size_t{1} << 30);
}

TEST(MeshAhead, ChangesNothingWithRoomForFewTiles) {
    fly(Expected::guessed, 2'000'000);
}

TEST(MeshAhead, AMotionGoesOnWithItsStepAndTurn) {
    SegmentView before = narrow(view_from({1, 0.2, 0.3}, 1e5, 300)), now = before;
    const double turn = 0.01;
    now.test.eye = now.culling.eye = before.test.eye + glm::dvec3(100, -20, 5);
    for (glm::dvec3& n : now.culling.inward)
        n = {std::cos(turn) * n.x - std::sin(turn) * n.y, std::sin(turn) * n.x + std::cos(turn) * n.y, n.z};
    const SegmentView after = view_after(before, now);
    EXPECT_EQ(after.test.eye, now.test.eye + (now.test.eye - before.test.eye));
    EXPECT_EQ(after.culling.eye, after.test.eye);
    EXPECT_EQ(after.culling.occluder_radius, now.culling.occluder_radius);
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 n = now.culling.inward[k];
        const glm::dvec3 turned{std::cos(turn) * n.x - std::sin(turn) * n.y,
                                std::sin(turn) * n.x + std::cos(turn) * n.y, n.z};
        EXPECT_LT(glm::length(after.culling.inward[k] - turned), 2 * turn * turn);
        EXPECT_NEAR(glm::length(after.culling.inward[k]), 1, 1e-12);
    }
    EXPECT_EQ(view_after(now, now).culling, now.culling);
}

}  // namespace
}  // namespace planet
