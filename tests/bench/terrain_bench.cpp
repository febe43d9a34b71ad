// Viewsheds, against what they are made of: a line of sight to every cell, which is exact, too. By cell of the grid, on one
// thread, from Blanca Peak over the shipped DEM.

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "planet/bake/bake.h"
#include "planet/elevation/raster_field.h"
#include "planet/geodesy/geodesic.h"
#include "planet/store/store_field.h"
#include "planet/terrain/viewshed.h"

namespace {

using namespace planet;

const Geodetic blanca{37.5775 * degrees, -105.4857 * degrees, {}};

const StoreField& ground() {
    static const StoreField field(std::make_shared<const ElevationStore>(bake_in_memory(
        *open_raster_field(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif", VerticalDatum::ellipsoid), {})));
    return field;
}

/// @param state radius, m; columns and rows of the grid
ViewshedOptions options_of(const benchmark::State& state) {
    ViewshedOptions options;
    options.radius = static_cast<double>(state.range(0));
    options.cell = 2 * options.radius / static_cast<double>(state.range(1) - 1);
    options.threads = 1;
    return options;
}

void set_cells(benchmark::State& state, double cells) {
    state.counters["a_cell"] =
        benchmark::Counter(cells, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void viewshed_grid(benchmark::State& state) {
    const ViewshedOptions options = options_of(state);
    std::size_t cells = 0, seen = 0;
    ground();
    for (auto _ : state) {
        const Viewshed view = viewshed(ground(), blanca, options);
        cells = view.count;
        seen = view.visible_count;
    }
    set_cells(state, static_cast<double>(cells));
    state.counters["seen"] = static_cast<double>(seen) / static_cast<double>(cells);
}

/// To cells drawn by lot: all of them would take minutes.
void line_of_sight_to_each(benchmark::State& state) {
    constexpr int cells = 2000;
    const ViewshedOptions options = options_of(state);
    const Geodesics lines;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<Geodetic> targets;
    for (int i = 0; i < cells; ++i) {
        const GeodesicPoint to =
            lines.direct(blanca, 360 * degrees * share(random), options.radius * std::sqrt(share(random)));
        targets.push_back({to.latitude, to.longitude, {}});
    }
    int seen = 0;
    for (auto _ : state) {
        seen = 0;
        for (const Geodetic& target : targets) seen += line_of_sight(ground(), blanca, target, options).visible;
    }
    set_cells(state, cells);
    state.counters["seen"] = static_cast<double>(seen) / cells;
}

void grids(benchmark::internal::Benchmark* b) {
    b->ArgNames({"radius_m", "side"})->Args({5000, 401})->Args({20000, 401})->Args({20000, 801})->Args({20000, 2001});
    b->Unit(benchmark::kMillisecond);
}
BENCHMARK(viewshed_grid)->Apply(grids);
BENCHMARK(line_of_sight_to_each)
    ->ArgNames({"radius_m", "side"})
    ->Args({5000, 401})
    ->Args({20000, 801})
    ->Unit(benchmark::kMillisecond);

}  // namespace
