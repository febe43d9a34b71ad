#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "patchy_store.h"
#include "planet/mesh/segments.h"
#include "planet/mesh/surface_check.h"
#include "planet/streaming/resident_tiles.h"
#include "planet/streaming/store_tiles.h"
#include "planet/streaming/view_needs.h"

namespace planet {
namespace {

using testing::crack_in;
using testing::hash_of;
using testing::narrow;
using testing::patchy_store;
using testing::patchy_views;
using testing::view_from;

/// Segments as they are drawn.
std::uint64_t segments_hash(const TileSource& tiles, const SegmentView& view) {
    Segments segments;
    segments.build(tiles, view);
    EXPECT_FALSE(segments.damaged());
    EXPECT_LE(segments.ratio_max(), 1);
    return segments.hash();
}

TEST(ResidentTiles, ASettledViewIsTheWholeStores) {
    const TileCache cache(patchy_store());
    const StoreTiles all(cache, Placement{});
    std::vector<std::uint64_t> want_mesh, want_segments;
    for (const SegmentView& v : patchy_views()) {
        want_mesh.push_back(hash_of(all, v.test));
        want_segments.push_back(segments_hash(all, v));
    }
    // Afresh for each view, and one view after the other, with room for everything and for nothing.
    for (const std::size_t limit : {std::size_t{1} << 30, std::size_t{1}}) {
        const TileCache own(patchy_store(), limit);
        ResidentTiles flying(own, Placement{}, 3);
        for (std::size_t k = 0; k < patchy_views().size(); ++k) {
            const SegmentView view = patchy_views()[k];
            ResidentTiles fresh(own, Placement{}, 2);
            for (ResidentTiles* tiles : {&fresh, &flying}) {
                tiles->settle(view);
                EXPECT_EQ(tiles->residency().pending, 0u);
                EXPECT_EQ(tiles->residency().hidden_ratio, 0);
                EXPECT_EQ(segments_hash(*tiles, view), want_segments[k]) << k << " " << limit;
                if (view.culling.occluder_radius == 0) {
                    EXPECT_EQ(hash_of(*tiles, view.test), want_mesh[k]) << k;
                }
            }
        }
    }
}

TEST(ResidentTiles, AViewInAnyStateOfLoadingIsFreeOfCracksAndCertified) {
    const TileCache cache(patchy_store(), 3'000'000);
    const StoreTiles all(cache, Placement{});
    ResidentTiles tiles(cache, Placement{}, 2);
    std::mt19937 random(9);
    const std::vector<SegmentView> list = patchy_views();
    std::size_t incomplete = 0;
    for (int step = 0; step < 60; ++step) {
        const SegmentView& view = list[random() % list.size()];
        tiles.update(view, step % 3 ? &list[random() % list.size()] : nullptr);
        ASSERT_EQ(crack_in(tiles, view.test), "") << step;
        const Residency& r = tiles.residency();
        incomplete += r.pending > 0;
        if (r.pending == 0) {
            EXPECT_EQ(segments_hash(tiles, view), segments_hash(all, view)) << step;
        }
    }
    EXPECT_GT(incomplete, 5u);
}

/// The largest deviation of leaves that the test would split if all tiles were there.
double hidden_deviation(const ResidentTiles& tiles, const SplitTest& test) {
    struct Sink {
        const ResidentTiles& tiles;
        const SplitTest& test;
        double worst = 0;
        void tile(const PlacedTile&) {}
        void leaf(const PlacedTile& t, unsigned i, unsigned) {
            SplitRecord s{};
            if (!(i >> t.depth)) {
                s = t.split[i];
            } else {
                const PlacedTile* below = tiles.tile(code_of(t, i));
                s = below ? below->split[1] : t.child_bound[t.position_below(i)];
            }
            s.deviation = std::abs(s.deviation);
            if (test(s)) worst = std::max(worst, static_cast<double>(s.deviation));
        }
    } sink{tiles, test};
    Walk walk(tiles, test, sink);
    for (int face = 0; face < face_count; ++face) walk.cell(*tiles.tile(LocationCode::face_root(face)), 1, 0);
    return sink.worst;
}

TEST(ResidentTiles, TheCertificateBoundsWhatHasNotCome) {
    const TileCache cache(patchy_store());
    std::size_t hiding = 0;
    for (const SegmentView& view : patchy_views()) {
        if (view.culling.occluder_radius > 0) continue;
        ResidentTiles tiles(cache, Placement{}, 1);
        for (;;) {
            tiles.update(view);
            const double hidden = hidden_deviation(tiles, view.test);
            EXPECT_LE(hidden, tiles.residency().hidden_deviation_m * 1.0001);
            hiding += hidden > 0;
            if (tiles.residency().pending == 0) break;
            tiles.wait();
        }
        EXPECT_EQ(hidden_deviation(tiles, view.test), 0);
    }
    EXPECT_GT(hiding, 3u);
}

TEST(ResidentTiles, MemoryStaysWithinItsLimitWhereTheViewAllows) {
    constexpr std::size_t limit = 4'000'000;
    const TileCache cache(patchy_store(), limit);
    ResidentTiles tiles(cache, Placement{}, 2);
    const SegmentView near = view_from(testing::PatchyField::patches[2].cap.centre, 1e5, 2000);
    const SegmentView far = view_from(testing::PatchyField::patches[1].cap.centre, 1e7, 100);
    tiles.settle(near);
    const ResidentCounts first = tiles.counts();
    EXPECT_GT(first.tile_bytes, limit);  // it is drawn anyway, and said
    EXPECT_GE(first.memory_peak_bytes, first.tile_bytes);
    EXPECT_EQ(first.memory_limit_bytes, limit);
    EXPECT_GE(first.tiles_loaded, first.tiles);
    tiles.settle(far);
    EXPECT_LE(tiles.counts().tile_bytes, limit);
    EXPECT_LE(cache.memory_bytes(), limit + 200'000);  // the last decoded one stays
    // What was dropped comes again.
    tiles.settle(near);
    EXPECT_EQ(tiles.counts().tile_bytes, first.tile_bytes);
    EXPECT_GT(tiles.counts().tiles_loaded, first.tiles_loaded);
}

TEST(ResidentTiles, TheMeshChangesOnlyWhereItIsSaid) {
    const TileCache cache(patchy_store(), 3'000'000);
    ResidentTiles tiles(cache, Placement{}, 2);
    std::mt19937 random(10);
    const std::vector<SegmentView> list = patchy_views();
    const SplitTest test = list[6].test;
    const auto leaves = [&] {
        const TriangleMesh mesh = refine_planet(tiles, test);
        return std::set<LocationCode>(mesh.cells.begin(), mesh.cells.end());
    };
    tiles.update(list[0]);
    std::set<LocationCode> before = leaves();
    std::size_t changed_leaves = 0;
    for (int step = 0; step < 40; ++step) {
        const SegmentView& view = list[random() % list.size()];
        const auto changes = step % 5 ? tiles.update(view, nullptr, step % 2 ? 8 : 1000) : tiles.settle(view);
        const std::set<LocationCode> after = leaves();
        std::vector<LocationCode> differ;
        std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                      std::back_inserter(differ));
        // A leaf that came or went lies in a cell that is named, or is one that holds such a cell.
        for (const LocationCode leaf : differ)
            ASSERT_TRUE(std::any_of(changes.begin(), changes.end(),
                                    [&](LocationCode c) { return c.contains(leaf) || leaf.contains(c); }));
        changed_leaves += differ.size();
        before = after;
    }
    EXPECT_GT(changed_leaves, 1000u);
}

TEST(ResidentTiles, WhatLiesAheadIsThereWhenTheEyeArrives) {
    const TileCache cache(patchy_store());
    ResidentTiles tiles(cache, Placement{}, 2);
    const glm::dvec3 here = testing::PatchyField::patches[2].cap.centre;
    const SegmentView now = view_from(-here, 1e7, 400), later = view_from(here, 1e5, 400);
    tiles.settle(now);
    const SegmentView ahead = view_ahead(now, (later.test.eye - now.test.eye) / 8.0, 8);
    EXPECT_LT(glm::distance(ahead.test.eye, later.test.eye), 1e-6);
    const auto pending_if_there = [&] {
        ResidentTiles fresh(cache, Placement{}, 2);
        fresh.update(later);
        return fresh.residency().pending;
    };
    ASSERT_GT(pending_if_there(), 0u);
    tiles.update(now, &later);
    while (tiles.on_their_way() > 0) {
        tiles.wait();
        tiles.update(now, &later);
        EXPECT_EQ(tiles.residency().pending, 0u);
    }
    tiles.update(later);
    EXPECT_EQ(tiles.residency().pending, 0u);
}

// With room for nothing, a little or all of what lies ahead: loading comes to an end, and what is needed now stays.
TEST(ResidentTiles, WhatLiesAheadTakesOnlyTheMemoryThatIsLeft) {
    const SegmentView now = view_from(testing::PatchyField::patches[1].cap.centre, 1e5, 400),
                      later = view_from(testing::PatchyField::patches[2].cap.centre, 1e5, 2000);
    std::size_t needed = 0;
    {
        const TileCache cache(patchy_store());
        ResidentTiles tiles(cache, {}, 2);
        tiles.settle(now);
        needed = tiles.counts().tile_bytes;
    }
    std::vector<std::size_t> loaded;
    for (const std::size_t limit : {needed / 2, needed + 700'000, needed + 100'000'000}) {
        const TileCache cache(patchy_store(), limit);
        ResidentTiles tiles(cache, {}, 2);
        tiles.settle(now);
        const ResidentCounts settled = tiles.counts();
        tiles.update(now, &later);
        while (tiles.on_their_way() > 0) {
            tiles.wait();
            tiles.update(now, &later);
            ASSERT_EQ(tiles.residency().pending, 0u);
        }
        EXPECT_LE(tiles.counts().tile_bytes, std::max(settled.tile_bytes, limit + 300'000)) << limit;
        loaded.push_back(tiles.counts().tiles_loaded - settled.tiles_loaded);
    }
    EXPECT_EQ(loaded[0], 0u);
    EXPECT_GT(loaded[1], 0u);
    EXPECT_GT(loaded[2], loaded[1] + 10);
}

TEST(ResidentTiles, AnotherExaggerationLoadsNothing) {
    const TileCache cache(patchy_store());
    const SegmentView view = view_from(testing::PatchyField::patches[0].cap.centre, 2e5, 100);
    ResidentTiles tiles(cache, Placement{}, 2);
    tiles.settle(view);
    const std::size_t loaded = tiles.counts().tiles_loaded;
    const std::uint64_t flat = hash_of(tiles, view.test);
    for (const double e : {3.0, 0.5, 1.0}) {
        const auto changes = tiles.place({wgs84, e});
        EXPECT_EQ(changes.size(), 8u);
        EXPECT_EQ(tiles.counts().tiles_loaded, loaded);
        ASSERT_EQ(crack_in(tiles, view.test), "");
        tiles.settle(view);
        const StoreTiles all(cache, {wgs84, e});
        EXPECT_EQ(hash_of(tiles, view.test), hash_of(all, view.test)) << e;
    }
    EXPECT_EQ(hash_of(tiles, view.test), flat);
}

}  // namespace
}  // namespace planet
