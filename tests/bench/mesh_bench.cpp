// The mesh from scratch, and the arithmetic under it. Baselines are in the same run: copying the same output, and a
// neighbour found by walking up and down the tree.

#include <benchmark/benchmark.h>

#include <cstring>
#include <random>

#include "ball_tiles.h"
#include "planet/frames.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/smooth_ellipsoid.h"

namespace {

using namespace planet;

std::vector<LocationCode> random_codes(std::size_t n) {
    std::mt19937_64 random(1);
    std::vector<LocationCode> codes;
    for (std::size_t i = 0; i < n; ++i) {
        const int d = 20 + static_cast<int>(random() % 30);
        codes.push_back(LocationCode::from_path(static_cast<int>(random() & 7), d, random() & ((1ull << d) - 1)));
    }
    return codes;
}

void neighbor_constant_time(benchmark::State& state) {
    const auto codes = random_codes(4096);
    for (auto _ : state) {
        std::uint64_t sum = 0;
        for (const LocationCode c : codes) sum += neighbor(c).bits();
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * codes.size()));
    state.counters["per_call"] = benchmark::Counter(static_cast<double>(state.iterations() * codes.size()),
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(neighbor_constant_time);

// Baseline: all three same-level neighbours of a cell follow from its parent's, level by level.
void neighbor_by_recursion(benchmark::State& state) {
    const auto codes = random_codes(4096);
    for (auto _ : state) {
        std::uint64_t sum = 0;
        for (const LocationCode code : codes) {
            const LocationCode root = LocationCode::face_root(code.face());
            std::uint64_t self = root.bits(), split = neighbor(root).bits(),
                          left = neighbor(root, Side::left_leg).bits(), right = neighbor(root, Side::right_leg).bits();
            for (int i = code.bisection_level() - 1; i >= 0; --i) {
                const bool one = code.bits() >> i & 1;
                const std::uint64_t sibling = self << 1 | !one;
                const std::uint64_t new_split = one ? right << 1 : left << 1 | 1;
                left = one ? sibling : split << 1 | 1;
                right = one ? split << 1 : sibling;
                split = new_split;
                self = self << 1 | one;
            }
            sum += split;
        }
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * codes.size()));
    state.counters["per_call"] = benchmark::Counter(static_cast<double>(state.iterations() * codes.size()),
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(neighbor_by_recursion);

struct Scene {
    testing::BallTiles tiles{40, 0.02};
    SplitTest test{ecef_from_normal(wgs84, normal_from_geodetic(0.65, -1.84), {637.0}), 0};

    Scene() {  // K for one million leaves
        const auto leaves = [this](double K) {
            test.K = K;
            return refine_planet(tiles, test).triangles.size();
        };
        double low = 1, high = 2;
        while (leaves(high) < 1'000'000) low = high, high *= 2;
        while (high / low > 1.0001) {
            const double middle = std::sqrt(low * high);
            (leaves(middle) < 1'000'000 ? low : high) = middle;
        }
    }
};

Scene& scene() {
    static Scene s;
    return s;
}

struct CountSink {
    std::size_t leaves = 0;
    void tile(const PlacedTile&) {}
    void leaf(const PlacedTile&, unsigned, unsigned) { ++leaves; }
};

// No heights, no tiles: everything from the bounds of 40 levels. The goal is 20 ms for a million leaves.
void smooth_from_scratch_with_strip(benchmark::State& state) {
    const Scene& s = scene();
    const auto bounds = s.tiles.bounds();
    SmoothEllipsoid mesh(wgs84);
    for (auto _ : state) {
        mesh.refine(bounds, s.test.eye, s.test.K);
        benchmark::DoNotOptimize(mesh.vertices().data());
    }
    state.counters["leaves"] = static_cast<double>(mesh.triangles());
    state.counters["indices"] = static_cast<double>(mesh.strip().size());
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * mesh.triangles()));
}
BENCHMARK(smooth_from_scratch_with_strip)->Unit(benchmark::kMillisecond);

void smooth_uniform_level_17(benchmark::State& state) {
    SmoothEllipsoid mesh(wgs84);
    for (auto _ : state) {
        mesh.refine_to_level(17);
        benchmark::DoNotOptimize(mesh.vertices().data());
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * mesh.triangles()));
}
BENCHMARK(smooth_uniform_level_17)->Unit(benchmark::kMillisecond);

void walk_only(benchmark::State& state) {
    Scene& s = scene();
    std::size_t leaves = 0;
    for (auto _ : state) {
        CountSink sink;
        Walk walk(s.tiles, s.test, sink);
        for (int f = 0; f < face_count; ++f) walk.cell(*s.tiles.tile(LocationCode::face_root(f)), 1, 0);
        benchmark::DoNotOptimize(leaves = sink.leaves);
    }
    state.counters["leaves"] = static_cast<double>(leaves);
    state.counters["tiles"] = static_cast<double>(s.tiles.tile_count());
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * leaves));
}
BENCHMARK(walk_only)->Unit(benchmark::kMillisecond);

void from_scratch_with_strip(benchmark::State& state) {
    Scene& s = scene();
    StripMesh mesh;
    for (auto _ : state) {
        mesh.refine(s.tiles, s.test);
        benchmark::DoNotOptimize(mesh.vertices().data());
    }
    state.counters["indices"] = static_cast<double>(mesh.strip().size());
    state.counters["vertices"] = static_cast<double>(mesh.vertices().size());
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * 2 * mesh.vertices().size()));
}
BENCHMARK(from_scratch_with_strip)->Unit(benchmark::kMillisecond);

// Baseline: writing the same bytes once.
void copy_the_same_output(benchmark::State& state) {
    Scene& s = scene();
    StripMesh mesh;
    mesh.refine(s.tiles, s.test);
    std::vector<GridPosition> vertices(mesh.vertices().size());
    std::vector<std::uint32_t> strip(mesh.strip().size());
    for (auto _ : state) {
        std::memcpy(vertices.data(), mesh.vertices().data(), vertices.size() * sizeof vertices[0]);
        std::memcpy(strip.data(), mesh.strip().data(), strip.size() * sizeof strip[0]);
        benchmark::ClobberMemory();
    }
}
BENCHMARK(copy_the_same_output)->Unit(benchmark::kMillisecond);

}  // namespace
