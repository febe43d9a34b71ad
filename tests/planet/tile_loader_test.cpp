#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <barrier>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <thread>

#include "patchy_store.h"
#include "planet/error.h"
#include "planet/streaming/store_tiles.h"
#include "planet/streaming/tile_loader.h"

namespace planet {
namespace {

using testing::patchy_store;

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

TEST(TileLoader, GivesSoManyTilesAndKeepsTheRest) {
    TileLoader loader([](LocationCode root) { return nothing(root); }, 1);
    std::vector<TileRequest> wanted;
    for (int face = 0; face < face_count; ++face) wanted.push_back({LocationCode::face_root(face), -1.0 * face});
    loader.request(wanted);
    loader.wait(face_count);
    std::vector<LocationCode> taken;
    for (const std::size_t most : {3u, 0u, 4u, 9u, 9u})
        for (const LoadedTile& tile : loader.take(most)) taken.push_back(tile.root);
    EXPECT_EQ(taken.size(), std::size_t{face_count});
    EXPECT_EQ(std::set(taken.begin(), taken.end()).size(), taken.size());
    EXPECT_EQ(loader.on_their_way(), 0u);
    loader.request({{LocationCode::face_root(0), 0}, {LocationCode::face_root(1), 0}});
    loader.wait(2);
    EXPECT_EQ(loader.take(1).size(), 1u);
    EXPECT_EQ(loader.on_their_way(), 1u);
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
        for (const LocationCode root : patchy_store().tiles()) many.push_back({root, 0});
        loader.request(many);
        if (trial % 2) loader.wait();
    }
}

// ---- the cache ------------------------------------------------------------------------------------------------------

TEST(TileCache, ThreadsThatWantTheSameTileGetTheSame) {
    const TileCache cache(patchy_store());
    for (const LocationCode root : patchy_store().tiles()) {
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
    const TileCache cache(patchy_store(), 2'000'000);
    for (const LocationCode root : patchy_store().tiles()) cache.tile(root);
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

}  // namespace
}  // namespace planet
