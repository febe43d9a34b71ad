// What baking does with every vertex of a tile: directions, positions, deviations, radii. Times are for a vertex of a
// whole leaf tile of the shipped DEM.

#include <benchmark/benchmark.h>

#include <cmath>
#include <map>

#include "bake_scene.h"
#include "planet/bake/coverage.h"
#include "planet/bake/sample_distance.h"
#include "planet/mesh/saturation.h"

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

// All cells and all radii that a leaf tile starts from. Baseline: radii cell by cell.
void leaf_records(benchmark::State& state) {
    const auto& scene = bake_scene();
    const auto& all = lattices();
    std::vector<float> deviation, radius;
    for (auto _ : state)
        for (std::size_t t = 0; t < all.size(); ++t) {
            const auto& exists = scene.leaves[t]->exists;
            deviation.resize(exists.size());
            radius.resize(exists.size());
            measure_leaf(all[t], exists, deviation, radius);
            benchmark::DoNotOptimize(radius.data());
        }
    count_vertices(state, scene.leaf_vertices);
}
BENCHMARK(leaf_records)->Unit(benchmark::kMillisecond);

void leaf_records_cell_by_cell(benchmark::State& state) {
    const auto& scene = bake_scene();
    const auto& all = lattices();
    std::vector<float> deviation, radius;
    for (auto _ : state)
        for (std::size_t t = 0; t < all.size(); ++t) {
            const unsigned cells = 1u << all[t].depth();
            deviation.resize(cells);
            radius.resize(cells);
            own_deviation(all[t], deviation);
            for (unsigned i = cells / 2; i < cells; ++i) radius[i] = certified_radius(corner_distance(all[t], i));
            benchmark::DoNotOptimize(radius.data());
        }
    count_vertices(state, scene.leaf_vertices);
}
BENCHMARK(leaf_records_cell_by_cell)->Unit(benchmark::kMillisecond);

// Records that are saturated already stay as they are: the same work every time. Baseline: a record at a time.
void saturation(benchmark::State& state) {
    const auto& scene = bake_scene();
    const auto& all = lattices();
    TileSaturation saturation;
    for (auto _ : state)
        for (std::size_t t = 0; t < all.size(); ++t) {
            Tile tile = scene.leaves[t]->tile;
            saturation.start(tile.depth, all[t].rounded());
            for (int level = tile.depth - 1; level >= 0; --level)
                saturation.level(level, scene.leaves[t]->exists, tile.deviation, tile.radius);
            benchmark::DoNotOptimize(tile.radius.data());
        }
    count_vertices(state, scene.leaf_vertices);
}
BENCHMARK(saturation)->Unit(benchmark::kMillisecond);

void saturation_by_record(benchmark::State& state) {
    const auto& scene = bake_scene();
    const auto& all = lattices();
    const TileLayout& layout = tile_layout();
    for (auto _ : state)
        for (std::size_t t = 0; t < all.size(); ++t) {
            Tile tile = scene.leaves[t]->tile;
            for (unsigned i = 1u << (tile.depth - 1); i-- > 1;) {
                const glm::vec3& m = all[t].rounded()[layout.split_vertex[i]];
                double reach = 0;
                for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
                    tile.deviation[i] = std::max(tile.deviation[i], tile.deviation[child]);
                    const glm::vec3& below = all[t].rounded()[layout.split_vertex[child]];
                    reach = std::max(reach, radius_over(m, below, tile.radius[child]));
                }
                tile.radius[i] = std::max(tile.radius[i], certified_radius(reach));
            }
            benchmark::DoNotOptimize(tile.radius.data());
        }
    count_vertices(state, scene.leaf_vertices);
}
BENCHMARK(saturation_by_record)->Unit(benchmark::kMillisecond);

// Every leaf tile against all cells that hold its root, as far as needed. Baseline: without asking what is needed.
void deviations_above(benchmark::State& state, bool pruned) {
    const auto& scene = bake_scene();
    const auto& all = lattices();
    std::map<LocationCode, std::pair<CellPlane, float>> cells;
    for (const BakedTile* t : scene.leaves)
        for (int level = 0; level < t->tile.root.bisection_level(); ++level) {
            const LocationCode cell = t->tile.root.ancestor(level);
            if (cells.contains(cell)) continue;
            const Corners c = corners(cell);
            const auto at = [&](const glm::dvec3& n) {
                const float h = scene.field->height(n);
                return scene.scale.placement.ecef(n, std::isnan(h) ? 0.0 : static_cast<double>(h), {});
            };
            cells[cell] = {CellPlane(at(c.left), at(c.right), at(c.apex)), 0.0f};
        }
    std::size_t tests = 0;
    for (auto _ : state) {
        tests = 0;
        for (auto& [cell, known] : cells) known.second = 0;
        for (std::size_t t = 0; t < all.size(); ++t) {
            const LocationCode root = scene.leaves[t]->tile.root;
            const TileHull hull(all[t]);
            for (int level = root.bisection_level() - 1; level >= 0; --level) {
                auto& [plane, known] = cells.find(root.ancestor(level))->second;
                if (pruned && !hull.may_exceed(plane, known)) continue;
                known = std::max(known, certified_deviation(deviation_from(all[t], plane)));
                ++tests;
            }
        }
    }
    count_vertices(state, scene.leaf_vertices);
    state.counters["tests_a_tile"] = static_cast<double>(tests) / static_cast<double>(all.size());
}
BENCHMARK_CAPTURE(deviations_above, as_needed, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(deviations_above, all, false)->Unit(benchmark::kMillisecond);

// What resampling lost in every eighth leaf tile, the field's samples given. Baseline: asking the field for them.
struct Samples {
    std::vector<std::size_t> leaf;
    std::vector<std::vector<glm::dvec3>> normals;
    std::vector<std::vector<float>> heights;
    std::size_t vertices = 0;

    Samples() {
        for (std::size_t t = 0; t < bake_scene().leaves.size(); t += 8) {
            leaf.push_back(t);
            vertices += lattices()[t].size();
            std::vector<glm::dvec3>& n = normals.emplace_back();
            std::vector<float>& h = heights.emplace_back();
            const SampleArea area(corners(bake_scene().leaves[t]->tile.root));
            bake_scene().field->sample_rows(area, [&](auto some_normals, auto some_heights) {
                n.insert(n.end(), some_normals.begin(), some_normals.end());
                h.insert(h.end(), some_heights.begin(), some_heights.end());
            });
        }
    }
};

void distances_of_samples(benchmark::State& state) {
    static const Samples samples;
    const auto& scene = bake_scene();
    SampleDistance distance;
    std::size_t exact = 0;
    for (auto _ : state) {
        exact = 0;
        for (std::size_t k = 0; k < samples.leaf.size(); ++k) {
            const BakedTile& t = *scene.leaves[samples.leaf[k]];
            distance.start(scene.scale.placement, t.tile, lattices()[samples.leaf[k]], t.exists, {});
            distance.add(samples.normals[k], samples.heights[k]);
            benchmark::DoNotOptimize(distance.largest());
            exact += distance.measured_exactly();
        }
    }
    count_vertices(state, samples.vertices);
    state.counters["exact_a_tile"] = static_cast<double>(exact) / static_cast<double>(samples.leaf.size());
}
BENCHMARK(distances_of_samples)->Unit(benchmark::kMillisecond);

void samples_of_the_field(benchmark::State& state) {
    const auto& scene = bake_scene();
    std::size_t vertices = 0;
    for (auto _ : state) {
        vertices = 0;
        for (std::size_t t = 0; t < scene.leaves.size(); t += 8) {
            const SampleArea area(corners(scene.leaves[t]->tile.root));
            scene.field->sample_rows(area, [](auto, auto heights) { benchmark::DoNotOptimize(heights.data()); });
            vertices += scene.leaves[t]->tile.height.size();
        }
    }
    count_vertices(state, vertices);
}
BENCHMARK(samples_of_the_field)->Unit(benchmark::kMillisecond);

}  // namespace
