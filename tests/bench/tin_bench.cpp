// TINs of rasters, against plain strict greedy insertion (every new triangle scanned at once, one heap) in the same
// run. Times are of the processor, summed over the threads, unless they are called real.

#include <benchmark/benchmark.h>

#include <map>

#include "mirrored_raster.h"
#include "planet/tin/border_line.h"
#include "planet/tin/error_grid.h"
#include "planet/tin/greedy_tin.h"
#include "planet/tin/make_tin.h"
#include "planet/tin/prune.h"
#include "planet/tin/quick_insertion.h"
#include "planet/tin/triangle_scan.h"

namespace {

using namespace planet;
using namespace planet::bench;

const HeightGrid& heights(int size) {
    static std::map<int, HeightGrid> grids;
    const auto found = grids.find(size);
    return found != grids.end() ? found->second : grids.emplace(size, HeightGrid(mirrored_raster(size))).first->second;
}

void set_counters(benchmark::State& state, std::size_t triangles) {
    state.counters["triangles"] = static_cast<double>(triangles);
    state.counters["per_triangle"] = benchmark::Counter(
        static_cast<double>(triangles), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// ---- to a tolerance ----

// size, tolerance
void to_tolerance_strictly(benchmark::State& state) {
    const HeightGrid& grid = heights(static_cast<int>(state.range(0)));
    std::size_t triangles = 0;
    for (auto _ : state) {
        Delaunay mesh = coarsest_tin(grid);
        GreedyOptions options;
        options.tolerance = static_cast<double>(state.range(1));
        triangles = insert_greedily(mesh, grid, options).triangles;
    }
    set_counters(state, triangles);
}
BENCHMARK(to_tolerance_strictly)
    ->ArgNames({"size", "metres"})
    ->ArgsProduct({{2049}, {5, 20, 50}})
    ->Args({513, 20})
    ->Args({4097, 20})
    ->Unit(benchmark::kMillisecond);

void to_tolerance(benchmark::State& state, TinQuality quality) {
    const HeightGrid& grid = heights(static_cast<int>(state.range(0)));
    std::size_t triangles = 0;
    for (auto _ : state)
        triangles =
            tiled_tin(grid, {static_cast<double>(state.range(1)), quality, static_cast<unsigned>(state.range(2))})
                .triangles.size();
    set_counters(state, triangles);
}
#define TO_TOLERANCE(quality)                                     \
    BENCHMARK_CAPTURE(to_tolerance, quality, TinQuality::quality) \
        ->ArgNames({"size", "metres", "threads"})                 \
        ->ArgsProduct({{2049, 4097}, {5, 20, 50}, {1}})           \
        ->Args({513, 20, 1})                                      \
        ->Args({4097, 20, 2})                                     \
        ->MeasureProcessCPUTime()                                 \
        ->UseRealTime()                                           \
        ->Unit(benchmark::kMillisecond)
TO_TOLERANCE(fast);
TO_TOLERANCE(standard);
TO_TOLERANCE(best);

// The floor: each triangle of the result scanned once, in double.
void certify(benchmark::State& state) {
    const HeightGrid& grid = heights(2049);
    const TinMesh mesh = tiled_tin(grid, {20, TinQuality::fast});
    double worst = 0;
    for (auto _ : state)
        for (const auto& t : mesh.triangles) {
            const SortedTriangle s({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]},
                                   {mesh.height[t[0]], mesh.height[t[1]], mesh.height[t[2]]});
            worst = std::max(worst, worst_sample<double>(grid, s, 1e9).deviation);
        }
    state.counters["max_m"] = worst;
    set_counters(state, mesh.triangles.size());
}
BENCHMARK(certify)->Unit(benchmark::kMillisecond);

// ---- budgets and measures ----

void to_budget(benchmark::State& state, TinMetric metric) {
    const HeightGrid& grid = heights(2049);
    const auto measure = make_measure(metric, grid);
    GreedyReport report;
    Delaunay mesh = coarsest_tin(grid);
    for (auto _ : state) {
        mesh = coarsest_tin(grid);
        GreedyOptions options;
        options.max_triangles = static_cast<std::size_t>(state.range(0));
        options.measure = measure.get();
        report = insert_greedily(mesh, grid, options);
    }
    double squares = 0;
    for (const float d : deviation_grid(mesh, grid)) squares += static_cast<double>(d) * static_cast<double>(d);
    state.counters["max_m"] = report.deviation_max;
    state.counters["rms_m"] = std::sqrt(squares / static_cast<double>(grid.count()));
    set_counters(state, report.triangles);
}
BENCHMARK_CAPTURE(to_budget, local, TinMetric::local)->Arg(50000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(to_budget, regional, TinMetric::regional)->Arg(50000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(to_budget, rms, TinMetric::rms)->Arg(50000)->Unit(benchmark::kMillisecond);

// ---- ways to locate: 1200 x 1200 samples, 500 triangles, as the paper has it ----

void locate(benchmark::State& state, LocateWay way) {
    const HeightGrid grid(heights(2049), {0, 0}, {1199, 1199});
    std::size_t measured = 0, triangles = 0;
    for (auto _ : state) {
        Delaunay mesh({0, 0}, {1199, 1199});
        measured = insert_by_error_grid(mesh, grid, 0, 500, way);
        triangles = mesh.triangle_count();
    }
    state.counters["samples_measured"] = static_cast<double>(measured);
    set_counters(state, triangles);
}
BENCHMARK_CAPTURE(locate, naive, LocateWay::naive)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(locate, cells, LocateWay::cells)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(locate, spans, LocateWay::spans)->Unit(benchmark::kMillisecond);

// The same TIN without an error grid.
void locate_by_triangles(benchmark::State& state) {
    const HeightGrid grid(heights(2049), {0, 0}, {1199, 1199});
    std::size_t triangles = 0;
    for (auto _ : state) {
        Delaunay mesh({0, 0}, {1199, 1199});
        GreedyOptions options;
        options.max_triangles = 500;
        triangles = insert_greedily(mesh, grid, options).triangles;
    }
    set_counters(state, triangles);
}
BENCHMARK(locate_by_triangles)->Unit(benchmark::kMillisecond);

// ---- the Delaunay triangulation alone ----

void insert_random_points(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    for (auto _ : state) {
        Delaunay mesh({0, 0}, {1 << 20, 1 << 20});
        std::uint64_t dice = 1;
        for (std::size_t i = 0; i < count; ++i) {  // each near the one before, as samples of a row are
            dice = dice * 6364136223846793005u + 1442695040888963407u;
            const int x = static_cast<int>((i << 20) / count), y = static_cast<int>(dice >> 44);
            mesh.insert({x, y});
        }
        benchmark::DoNotOptimize(mesh.triangle_count());
    }
    state.counters["per_point"] = benchmark::Counter(
        static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(insert_random_points)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
