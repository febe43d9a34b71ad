#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <random>
#include <thread>

#include "patchy_store.h"
#include "planet/error.h"
#include "planet/mesh/segments.h"
#include "planet/mesh/surface_check.h"
#include "planet/store/resident_tiles.h"
#include "planet/store/store_tiles.h"
#include "planet/store/tile_loader.h"
#include "planet/store/tile_sides.h"
#include "planet/store/view_needs.h"

namespace planet {
namespace {

using testing::crack_in;
using testing::hash_of;

const ElevationStore& store() {
    static const ElevationStore baked = bake_in_memory(testing::PatchyField(), testing::patchy_options());
    return baked;
}

SegmentView view_from(const glm::dvec3& towards, double height, double K) {
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, glm::normalize(towards), {height}), K};
    view.culling.eye = view.test.eye;
    return view;
}

/// Looking at a place from above it, 40 degrees wide.
SegmentView narrow(SegmentView view) {
    const glm::dvec3 down = -glm::normalize(view.test.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(down, glm::dvec3(0.3, -0.2, 0.9))), up = glm::cross(right, down);
    const double s = std::sin(20 * degrees), c = std::cos(20 * degrees);
    view.culling.inward = {s * down + c * right, s * down - c * right, s * down + c * up, s * down - c * up};
    view.culling.occluder_radius = 6.33e6;
    return view;
}

/// Over every patch, from far to near.
std::vector<SegmentView> views() {
    std::vector<SegmentView> list;
    for (const testing::PatchyField::Patch& p : testing::PatchyField::patches)
        for (const double height : {2e7, 1e6, 1e5, 1e4})
            for (const bool whole : {true, false}) {
                const SegmentView view = view_from(p.cap.centre + glm::dvec3(1e-4, 2e-4, -1e-4), height, 400);
                list.push_back(whole ? view : narrow(view));
            }
    return list;
}

std::unique_ptr<PlacedTile> placed(LocationCode root, double exaggeration = 1) {
    return std::make_unique<PlacedTile>(*store().read(root), Placement{wgs84, exaggeration});
}

bool same(const SplitRecord& a, const SplitRecord& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// ---- tiles placed for drawing ---------------------------------------------------------------------------------------

TEST(PlacedTile, PlacedAnewIsTheSameAsPlacedAtOnce) {
    for (const LocationCode root : store().tiles()) {
        const PlacedTile once(*store().read(root), Placement{wgs84, 3}), flat(*store().read(root), Placement{});
        const PlacedTile there(flat, Placement{wgs84, 3}), back(there, Placement{});
        for (unsigned i = 1; i < 1u << once.depth; ++i) {
            ASSERT_TRUE(same(once.split[i], there.split[i]));
            ASSERT_TRUE(same(flat.split[i], back.split[i]));
        }
        EXPECT_EQ(once.position, there.position);
        EXPECT_EQ(flat.position, back.position);
        EXPECT_EQ(once.height, there.height);
        for (unsigned k = 0; k < tile_cells; ++k) {
            ASSERT_TRUE(same(once.child_bound[k], there.child_bound[k]));
            ASSERT_TRUE(same(flat.child_bound[k], back.child_bound[k]));
        }
    }
}

TEST(PlacedTile, KnowsWhereTilesAreBelow) {
    for (const LocationCode root : store().tiles()) {
        const Tile tile = *store().read(root);
        const PlacedTile p(tile, Placement{});
        EXPECT_EQ(p.child_bound.empty(), tile.child_exists.none());
        for (unsigned k = 0; k < tile_cells; ++k) ASSERT_EQ(p.child_bound.has(k), tile.child_exists[k]);
        std::vector<bool> below(2 * tile_cells);
        for (unsigned i = 2 * tile_cells - 1; i >= 1; --i) {
            below[i] = i >= tile_cells ? tile.child_exists[i - tile_cells] : below[2 * i] || below[2 * i + 1];
            ASSERT_EQ(p.has_child_below(i), below[i]) << i;
        }
    }
}

ResidentTile& insert(ResidentSet& set, LocationCode root) {
    std::unique_ptr<PlacedTile> tile = placed(root);
    const int depth = tile->depth;
    return set.insert(std::move(tile), tile_support(root, depth));
}

// ---- the set of tiles in memory -------------------------------------------------------------------------------------

/// The rule as it is written, without any memory.
class Existence {
  public:
    explicit Existence(const ResidentSet& set) : set_(set) {}
    bool of(LocationCode cell) {
        const LocationCode name = diamond(cell);
        const auto known = known_.find(name);
        if (known != known_.end()) return known->second;
        bool exists = true;
        for (const LocationCode half : {cell, neighbor(cell)}) {
            const auto [root, local] = cell_in_tile(half);
            const PlacedTile* tile = set_.tile(root);
            exists = exists && tile && !(local >> tile->depth) && tile->is_stored(local);
        }
        if (exists && cell.bisection_level() > 0) exists = of(cell.parent()) && of(neighbor(cell).parent());
        return known_[name] = exists;
    }

  private:
    const ResidentSet& set_;
    std::map<LocationCode, bool> known_;
};

void expect_rule(ResidentSet& set) {
    Existence existence(set);
    for (const ResidentTile* t : set.all())
        for (unsigned i = 1; i < 1u << t->tile->depth; ++i)
            ASSERT_EQ(t->tile->is_open(i), existence.of(cell_code(t->root, i))) << to_string(t->root) << " " << i;
}

/// Adds or takes out tiles at random, keeping parents. @return whether anything was done
bool change_at_random(ResidentSet& set, std::mt19937& random) {
    const std::vector<LocationCode> roots = store().tiles();
    const LocationCode root = roots[random() % roots.size()];
    if (ResidentTile* const there = set.find(root)) {
        if (there->children > 0 || root.bisection_level() == 0) return false;
        set.erase(root);
        return true;
    }
    if (root.bisection_level() > 0 && !set.find(root.ancestor(root.bisection_level() - tile_levels))) return false;
    insert(set, root);
    return true;
}

TEST(ResidentSet, TheRuleHoldsAfterAnyChanges) {
    std::mt19937 random(1);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    set.settle();
    expect_rule(set);
    for (int step = 0; step < 40; ++step) {
        for (int changes = 0; changes < 1 + step;) changes += change_at_random(set, random);
        set.settle();
        expect_rule(set);
    }
}

TEST(ResidentSet, EveryDiamondIsOpenWhereAllTilesAreThere) {
    ResidentSet set;
    for (const LocationCode root : store().tiles()) insert(set, root);
    set.settle();
    for (const ResidentTile* t : set.all())
        for (unsigned i = 1; i < 1u << t->tile->depth; ++i) ASSERT_EQ(t->tile->is_open(i), t->tile->is_stored(i));
    for (const LocationCode root : store().tiles()) EXPECT_EQ(set.tile(root)->root, root);
    EXPECT_EQ(set.size(), store().tiles().size());
}

TEST(ResidentSet, NoWalkMeetsACrackWhicheverTilesAreThere) {
    std::mt19937 random(2);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    std::size_t triangles = 0;
    for (int step = 0; step < 24; ++step) {
        for (int changes = 0; changes < 40;) changes += change_at_random(set, random);
        set.settle();
        const SplitTest test = views()[static_cast<std::size_t>(step)].test;
        ASSERT_EQ(crack_in(set, test), "") << step;
        const SurfaceCheck c = check(refine_planet(set, test));
        ASSERT_TRUE(c.closed()) << c.summary();
        triangles += c.triangles;
    }
    EXPECT_GT(triangles, 50000u);
}

// What take_changes() does not name must be the same mesh as before.
TEST(ResidentSet, ChangesNameEveryCellThatIsSplitOtherwise) {
    std::mt19937 random(3);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    set.settle();
    set.take_changes();
    const auto open_cells = [&set] {
        std::set<LocationCode> open;
        for (const ResidentTile* t : set.all())
            for (unsigned i = 1; i < 1u << t->tile->depth; ++i)
                if (t->tile->is_open(i)) open.insert(cell_code(t->root, i));
        return open;
    };
    std::set<LocationCode> before = open_cells();
    std::size_t flips = 0;
    for (int step = 0; step < 30; ++step) {
        for (int changes = 0; changes < 40;) changes += change_at_random(set, random);
        set.settle();
        const std::set<LocationCode> after = open_cells();
        const std::vector<LocationCode> changed = set.take_changes();
        for (std::size_t k = 1; k < changed.size(); ++k) ASSERT_FALSE(changed[k - 1].contains(changed[k]));
        std::vector<LocationCode> flipped;
        std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                      std::back_inserter(flipped));
        for (const LocationCode cell : flipped)
            ASSERT_TRUE(std::any_of(changed.begin(), changed.end(), [&](LocationCode c) { return c.contains(cell); }))
                << to_string(cell);
        flips += flipped.size();
        before = after;
    }
    EXPECT_GT(flips, 200u);
    EXPECT_TRUE(set.take_changes().empty());
}

TEST(ResidentSet, ATileAndItsSupportOpenAllItsDiamonds) {
    std::mt19937 random(4);
    const std::vector<LocationCode> roots = store().tiles();
    std::size_t most = 0;
    for (int trial = 0; trial < 30; ++trial) {
        ResidentSet set;
        const LocationCode root = roots[random() % roots.size()];
        const std::function<void(LocationCode)> add = [&](LocationCode r) {
            if (set.find(r)) return;
            if (r.bisection_level() > 0) add(r.ancestor(r.bisection_level() - tile_levels));
            if (!store().read(r)) return;
            const std::size_t supporting = insert(set, r).support.size();
            if (r.bisection_level() > 0) most = std::max(most, supporting);
        };
        // The tile, those above all of its support with theirs, and so on up.
        std::vector<LocationCode> level{root};
        while (!level.empty()) {
            std::set<LocationCode> above;
            for (const LocationCode r : level) {
                const auto tile = store().read(r);
                if (!tile) continue;
                add(r);
                for (const LocationCode s : tile_support(r, tile->depth)) {
                    add(s);
                    if (s.bisection_level() > 0) above.insert(s.ancestor(s.bisection_level() - tile_levels));
                }
            }
            level.assign(above.begin(), above.end());
        }
        set.settle();
        const PlacedTile& t = *set.tile(root);
        for (unsigned i = 1; i < 1u << t.depth; ++i) ASSERT_EQ(t.is_open(i), t.is_stored(i)) << to_string(root);
    }
    EXPECT_GE(most, 11u);  // 12 to 16 tiles refine one
    EXPECT_LE(most, 16u);
}

// ---- loading by other threads ---------------------------------------------------------------------------------------

LoadedTile nothing(LocationCode root) {
    return {root, nullptr, false, {}};
}

TEST(TileLoader, LoadsTheMostWantedFirst) {
    std::mutex mutex;
    std::condition_variable open;
    bool gate = false;
    std::vector<LocationCode> order;
    TileLoader loader(
        [&](LocationCode root) {
            std::unique_lock lock(mutex);
            open.wait(lock, [&] { return gate; });
            order.push_back(root);
            return nothing(root);
        },
        1);
    const auto at = [](int face) { return LocationCode::face_root(face); };
    loader.request({{at(0), 0}});  // begun, or withdrawn by the next request
    loader.request({{at(3), 1}, {at(5), 7}, {at(4), 1}, {at(7), -2}});
    {
        const std::lock_guard lock(mutex);
        gate = true;
    }
    open.notify_all();
    while (loader.on_their_way() > 0) {
        loader.wait();
        loader.take();
    }
    std::erase(order, at(0));
    EXPECT_EQ(order, (std::vector{at(5), at(3), at(4), at(7)}));
}

TEST(TileLoader, WhatIsNoLongerWantedIsNotLoaded) {
    std::mutex mutex;
    std::condition_variable changed;
    int begun = 0;
    bool gate = false;
    TileLoader loader(
        [&](LocationCode root) {
            std::unique_lock lock(mutex);
            ++begun;
            changed.notify_all();
            changed.wait(lock, [&] { return gate; });
            return nothing(root);
        },
        1);
    std::vector<TileRequest> faces;
    for (int face = 0; face < face_count; ++face) faces.push_back({LocationCode::face_root(face), 1.0 * face});
    loader.request(faces);
    {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return begun == 1; });
    }
    loader.request(faces);  // what is being loaded is not loaded again
    EXPECT_EQ(loader.on_their_way(), 8u);
    loader.request({});
    EXPECT_EQ(loader.on_their_way(), 1u);
    {
        const std::lock_guard lock(mutex);
        gate = true;
    }
    changed.notify_all();
    loader.wait();
    ASSERT_EQ(loader.take().size(), 1u);
    EXPECT_EQ(begun, 1);
    loader.wait();  // nothing is on its way: returns
    EXPECT_TRUE(loader.take().empty());
}

TEST(TileLoader, WhatLoadingThrowsIsThrownOn) {
    TileLoader loader([](LocationCode root) -> LoadedTile {
        if (root.face() == 3) throw Error(Fault::bad_usage, "here", "no");
        return nothing(root);
    });
    loader.request({{LocationCode::face_root(3), 1}});
    loader.wait();
    EXPECT_THROW(loader.take(), Error);
    loader.request({{LocationCode::face_root(2), 1}});
    loader.wait();
    EXPECT_EQ(loader.take().size(), 1u);
}

TEST(TileLoader, EndsWithRequestsOnTheirWay) {
    for (int trial = 0; trial < 50; ++trial) {
        TileLoader loader(nothing, 3);
        std::vector<TileRequest> many;
        for (const LocationCode root : store().tiles()) many.push_back({root, 0});
        loader.request(many);
        if (trial % 2) loader.wait();
    }
}

// ---- the cache ------------------------------------------------------------------------------------------------------

TEST(TileCache, ThreadsThatWantTheSameTileGetTheSame) {
    const TileCache cache(store());
    for (const LocationCode root : store().tiles()) {
        std::array<std::shared_ptr<const Tile>, 4> got;
        std::barrier together(4);
        std::vector<std::jthread> threads;
        for (auto& tile : got)
            threads.emplace_back([&] {
                together.arrive_and_wait();
                tile = cache.tile(root);
            });
        threads.clear();
        for (const auto& tile : got) ASSERT_EQ(tile, got[0]);  // one copy: loaded once
    }
}

TEST(TileCache, TilesForDrawingCountAgainstTheLimit) {
    const TileCache cache(store(), 2'000'000);
    for (const LocationCode root : store().tiles()) cache.tile(root);
    const std::size_t decoded = cache.memory_bytes();
    EXPECT_GT(decoded, 1'500'000u);
    EXPECT_LE(decoded, 2'000'000u);
    {
        const StoreTiles tiles(cache, Placement{});
        for (int face = 0; face < face_count; ++face) tiles.tile(LocationCode::face_root(face));
        EXPECT_GT(tiles.bytes(), 300'000u);
        EXPECT_GE(cache.memory_bytes(), tiles.bytes());
        EXPECT_LE(cache.memory_bytes(), 2'000'000u);
        cache.count_drawn_bytes(5'000'000);  // beyond the limit: one decoded tile is left
        EXPECT_LE(cache.memory_bytes(), tiles.bytes() + 5'200'000);
        cache.count_drawn_bytes(-5'000'000);
    }
    EXPECT_LE(cache.memory_bytes(), 200'000u);
    EXPECT_GE(cache.memory_peak_bytes(), 5'000'000u);
}

// ---- resident tiles -------------------------------------------------------------------------------------------------

/// Segments as they are drawn.
std::uint64_t segments_hash(const TileSource& tiles, const SegmentView& view) {
    Segments segments;
    segments.build(tiles, view);
    EXPECT_FALSE(segments.damaged());
    EXPECT_LE(segments.ratio_max(), 1);
    return segments.hash();
}

TEST(ResidentTiles, ASettledViewIsTheWholeStores) {
    const TileCache cache(store());
    const StoreTiles all(cache, Placement{});
    std::vector<std::uint64_t> want_mesh, want_segments;
    for (const SegmentView& v : views()) {
        want_mesh.push_back(hash_of(all, v.test));
        want_segments.push_back(segments_hash(all, v));
    }
    // Afresh for each view, and one view after the other, with room for everything and for nothing.
    for (const std::size_t limit : {std::size_t{1} << 30, std::size_t{1}}) {
        const TileCache own(store(), limit);
        ResidentTiles flying(own, Placement{}, 3);
        for (std::size_t k = 0; k < views().size(); ++k) {
            const SegmentView view = views()[k];
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
    const TileCache cache(store(), 3'000'000);
    const StoreTiles all(cache, Placement{});
    ResidentTiles tiles(cache, Placement{}, 2);
    std::mt19937 random(9);
    const std::vector<SegmentView> list = views();
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
            } else if (t.depth == tile_levels) {
                const PlacedTile* below = tiles.tile(code_of(t, i));
                s = below ? below->split[1] : t.child_bound[i - tile_cells];
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
    const TileCache cache(store());
    std::size_t hiding = 0;
    for (const SegmentView& view : views()) {
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
    const TileCache cache(store(), limit);
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
    const TileCache cache(store(), 3'000'000);
    ResidentTiles tiles(cache, Placement{}, 2);
    std::mt19937 random(10);
    const std::vector<SegmentView> list = views();
    const SplitTest test = list[6].test;
    const auto leaves = [&] {
        const TriangleMesh mesh = refine_planet(tiles, test);
        return std::set<LocationCode>(mesh.cells.begin(), mesh.cells.end());
    };
    tiles.update(list[0]);
    std::set<LocationCode> before = leaves();
    std::size_t changed_leaves = 0;
    for (int step = 0; step < 40; ++step) {
        const auto changes =
            step % 5 ? tiles.update(list[random() % list.size()]) : tiles.settle(list[random() % list.size()]);
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
    const TileCache cache(store());
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
        const TileCache cache(store());
        ResidentTiles tiles(cache, {}, 2);
        tiles.settle(now);
        needed = tiles.counts().tile_bytes;
    }
    std::vector<std::size_t> loaded;
    for (const std::size_t limit : {needed / 2, needed + 700'000, needed + 100'000'000}) {
        const TileCache cache(store(), limit);
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
    const TileCache cache(store());
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
