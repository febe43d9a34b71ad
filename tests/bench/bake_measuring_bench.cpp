// What baking does with every vertex of a tile: directions, positions, deviations, radii. Times are for a vertex of a
// whole leaf tile of the shipped DEM.

#include <benchmark/benchmark.h>

#include <cstring>

#include "bake_scene.h"

namespace {

using namespace planet;
using bench::bake_scene;

void count_vertices(benchmark::State& state, std::size_t vertices) {
    const auto all = static_cast<double>(vertices) * static_cast<double>(state.iterations());
    state.counters["per_vertex"] = benchmark::Counter(all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Lattices of all leaf tiles, once.
const std::vector<TileLattice>& lattices() {
    static const std::vector<TileLattice> all = [] {
        std::vector<TileLattice> made;
        for (const BakedTile* t : bake_scene().leaves) {
            made.emplace_back().set_normals(corners(t->tile.root), t->tile.depth);
            made.back().set_positions(bake_scene().scale.placement, t->tile.height, {}, {});
        }
        return made;
    }();
    return all;
}

void normals(benchmark::State& state) {
    TileLattice lattice;
    const auto& scene = bake_scene();
    for (auto _ : state)
        for (const BakedTile* t : scene.leaves) {
            lattice.set_normals(corners(t->tile.root), t->tile.depth);
            benchmark::DoNotOptimize(lattice.normals(0));
        }
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(normals)->Unit(benchmark::kMillisecond);

void positions(benchmark::State& state) {
    TileLattice lattice = lattices().front();
    const auto& scene = bake_scene();
    for (auto _ : state)
        for (const BakedTile* t : scene.leaves)
            if (t->tile.height.size() == lattice.size()) {
                lattice.set_positions(scene.scale.placement, t->tile.height, {}, {});
                benchmark::DoNotOptimize(lattice.positions(0));
            }
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(positions)->Unit(benchmark::kMillisecond);

// Baseline of both: the same arrays, copied.
void copying_coordinates(benchmark::State& state) {
    std::vector<double> copy[6];
    const auto& all = lattices();
    for (auto _ : state)
        for (const TileLattice& lattice : all)
            for (int k = 0; k < 6; ++k) {
                const double* from = k < 3 ? lattice.normals(k) : lattice.positions(k - 3);
                copy[k].assign(from, from + lattice.size());
                benchmark::DoNotOptimize(copy[k].data());
            }
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(copying_coordinates)->Unit(benchmark::kMillisecond);

void own_deviations(benchmark::State& state) {
    std::vector<float> deviation;
    const auto& all = lattices();
    for (auto _ : state)
        for (const TileLattice& lattice : all) {
            deviation.resize(std::size_t{1} << lattice.depth());
            own_deviation(lattice, deviation);
            benchmark::DoNotOptimize(deviation.data());
        }
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(own_deviations)->Unit(benchmark::kMillisecond);

// Baseline: every vertex against one plane.
void deviations_from_one_plane(benchmark::State& state) {
    const CellPlane plane(glm::dvec3(6.4e6, 0, 0), glm::dvec3(0, 6.4e6, 0), glm::dvec3(0, 0, 6.4e6));
    const auto& all = lattices();
    for (auto _ : state)
        for (const TileLattice& lattice : all) benchmark::DoNotOptimize(deviation_from(lattice, plane));
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(deviations_from_one_plane)->Unit(benchmark::kMillisecond);

void radii_of_corners(benchmark::State& state) {
    std::vector<float> radius;
    const auto& scene = bake_scene();
    const auto& all = lattices();
    for (auto _ : state)
        for (std::size_t t = 0; t < all.size(); ++t) {
            const BakedTile& tile = *scene.leaves[t];
            radius.resize(tile.exists.size());
            corner_radii(all[t], tile.exists, false, {}, radius);
            benchmark::DoNotOptimize(radius.data());
        }
    count_vertices(state, bake_scene().leaf_vertices);
}
BENCHMARK(radii_of_corners)->Unit(benchmark::kMillisecond);

}  // namespace
