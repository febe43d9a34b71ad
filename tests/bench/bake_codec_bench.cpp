// Tiles as bytes and back, for a vertex of a whole leaf tile of the shipped DEM. Baseline: zstd over the same heights as
// 16-bit differences.

#include <benchmark/benchmark.h>
#include <zstd.h>

#include "bake_scene.h"

namespace {

using namespace planet;
using bench::bake_scene;

void count_vertices(benchmark::State& state, std::size_t bytes) {
    const auto vertices = static_cast<double>(bake_scene().leaf_vertices);
    state.counters["per_vertex"] = benchmark::Counter(vertices * static_cast<double>(state.iterations()),
                                                      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["bytes_a_vertex"] = static_cast<double>(bytes) / vertices;
}

const std::vector<std::vector<std::uint8_t>>& encoded() {
    static const auto all = [] {
        std::vector<std::vector<std::uint8_t>> made;
        for (const BakedTile* t : bake_scene().leaves) made.push_back(encode_tile(*t, bake_scene().scale));
        return made;
    }();
    return all;
}

void encoding(benchmark::State& state) {
    std::size_t bytes = 0;
    const auto& scene = bake_scene();
    for (auto _ : state) {
        bytes = 0;
        for (const BakedTile* t : scene.leaves) bytes += encode_tile(*t, scene.scale).size();
    }
    count_vertices(state, bytes);
}
BENCHMARK(encoding)->Unit(benchmark::kMillisecond);

void decoding(benchmark::State& state) {
    std::size_t bytes = 0;
    const auto& scene = bake_scene();
    const auto& frames = encoded();
    for (auto _ : state) {
        bytes = 0;
        for (std::size_t t = 0; t < frames.size(); ++t) {
            const Tile tile = decode_tile(scene.leaves[t]->tile.root, frames[t], scene.scale);
            benchmark::DoNotOptimize(tile.height.data());
            bytes += frames[t].size();
        }
    }
    count_vertices(state, bytes);
}
BENCHMARK(decoding)->Unit(benchmark::kMillisecond);

void placing(benchmark::State& state) {
    const auto& scene = bake_scene();
    for (auto _ : state)
        for (const BakedTile* t : scene.leaves) {
            const PlacedTile placed(t->tile, scene.scale.placement);
            benchmark::DoNotOptimize(placed.position.data());
        }
    count_vertices(state, 0);
}
BENCHMARK(placing)->Unit(benchmark::kMillisecond);

void zstd_of_differences(benchmark::State& state) {
    std::vector<std::uint8_t> frame(1 << 16);
    std::vector<std::int16_t> difference;
    std::size_t bytes = 0;
    const auto& scene = bake_scene();
    for (auto _ : state) {
        bytes = 0;
        for (const BakedTile* t : scene.leaves) {
            difference.clear();
            float before = 0;
            for (const float h : t->tile.height) {
                difference.push_back(static_cast<std::int16_t>(4 * (h - before)));
                before = h;
            }
            bytes += ZSTD_compress(frame.data(), frame.size(), difference.data(), 2 * difference.size(), 1);
        }
    }
    count_vertices(state, bytes);
}
BENCHMARK(zstd_of_differences)->Unit(benchmark::kMillisecond);

}  // namespace
