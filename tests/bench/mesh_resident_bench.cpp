// Tiles on their way from a store to the walk: loading, placing, what a view needs, from frame to frame.

#include <benchmark/benchmark.h>

#include "patchy_store.h"
#include "planet/streaming/resident_tiles.h"

namespace planet {
namespace {

struct Scene {
    ElevationStore store = bake_in_memory(testing::PatchyField(), testing::patchy_options());
    std::vector<LocationCode> roots = store.tiles();

    static SegmentView view(double metres_on) {
        SegmentView v;
        const glm::dvec3 over = testing::PatchyField::patches[2].cap.centre;
        const glm::dvec3 on = glm::normalize(glm::cross(over, glm::dvec3(0, 0, 1)));
        v.test = {ecef_from_normal(wgs84, over, {5e4}) + metres_on * on, 3000};
        v.culling.eye = v.test.eye;
        v.culling.occluder_radius = 6.34e6;
        return v;
    }
};

const Scene& scene() {
    static const Scene s;
    return s;
}

void per_tile(benchmark::State& state, std::size_t tiles) {
    state.counters["per_tile"] = benchmark::Counter(static_cast<double>(state.iterations() * tiles),
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// The baseline of what follows: SQLite, zstd, deviations measured anew.
void read_tiles(benchmark::State& state) {
    for (auto _ : state)
        for (const LocationCode root : scene().roots) benchmark::DoNotOptimize(scene().store.read(root));
    per_tile(state, scene().roots.size());
}
BENCHMARK(read_tiles)->Unit(benchmark::kMillisecond);

void place_tiles(benchmark::State& state) {
    std::vector<Tile> tiles;
    for (const LocationCode root : scene().roots) tiles.push_back(*scene().store.read(root));
    std::size_t bytes = 0;
    for (auto _ : state) {
        bytes = 0;
        for (const Tile& t : tiles) bytes += PlacedTile(t, Placement{}).bytes();
    }
    per_tile(state, tiles.size());
    state.counters["bytes"] = static_cast<double>(bytes) / static_cast<double>(tiles.size());
}
BENCHMARK(place_tiles)->Unit(benchmark::kMillisecond);

void find_support(benchmark::State& state) {
    for (auto _ : state)
        for (const LocationCode root : scene().roots) benchmark::DoNotOptimize(tile_support(root, tile_levels));
    per_tile(state, scene().roots.size());
}
BENCHMARK(find_support)->Unit(benchmark::kMillisecond);

// All of it, by so many threads.
void settle_from_nothing(benchmark::State& state) {
    std::size_t tiles = 0;
    for (auto _ : state) {
        const TileCache cache(scene().store);
        ResidentTiles resident(cache, {}, static_cast<unsigned>(state.range(0)));
        resident.settle(Scene::view(0));
        tiles = resident.counts().tiles;
    }
    per_tile(state, tiles);
    state.counters["tiles"] = static_cast<double>(tiles);
}
BENCHMARK(settle_from_nothing)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void update_at_rest(benchmark::State& state) {
    const TileCache cache(scene().store);
    ResidentTiles resident(cache, {}, 1);
    resident.settle(Scene::view(0));
    for (auto _ : state) resident.update(Scene::view(0));
}
BENCHMARK(update_at_rest)->Unit(benchmark::kMicrosecond);

void update_moving(benchmark::State& state) {
    const TileCache cache(scene().store);
    ResidentTiles resident(cache, {}, 1);
    resident.settle(Scene::view(0));
    double on = 0;
    for (auto _ : state) resident.update(Scene::view(on += 0.001));
    per_tile(state, resident.counts().tiles);
}
BENCHMARK(update_moving)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace planet
