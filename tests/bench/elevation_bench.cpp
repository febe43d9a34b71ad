// Heights and samples out of elevation files of any size, in the order of a bake. Baselines in the same run: the same
// places in memory, nearest samples alone, and copies of as many values.
//
// OCTAGLOBE_BENCH_RASTER names a raster to sample instead of the one that ships, read in blocks of 64 MiB.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <map>

#include "planet/elevation/blocked_raster.h"
#include "planet/elevation/elevation_sources.h"
#include "planet/elevation/raster_field.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace {

using namespace planet;

constexpr const char* shipped = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";

std::string file() {
    const char* named = std::getenv("OCTAGLOBE_BENCH_RASTER");
    return named ? named : shipped;
}

std::shared_ptr<const RasterField> blocked() {
    static const auto field = [] {
        const auto mosaic = std::make_shared<const RasterMosaic>(std::vector{mosaic_part(file())}, "bench");
        const auto samples =
            std::make_shared<const BlockedRaster>(mosaic, std::make_shared<BlockCache>(std::size_t{64} << 20));
        return std::make_shared<const RasterField>(samples, samples->survey(), VerticalDatum::egm96);
    }();
    return field;
}

std::shared_ptr<const RasterField> whole() {
    static const auto field = open_raster_field(shipped, VerticalDatum::egm96);
    return field;
}

// Split vertices below a cell in ascending codes, as many levels down as give a vertex a sample.
void add_vertices(const LocationCode& cell, const Corners& c, int levels, std::vector<glm::dvec3>& out) {
    const glm::dvec3 m = split_vertex(c);
    out.push_back(m);
    if (levels <= 1) return;
    for (int i = 0; i < 2; ++i) add_vertices(cell.child(i), child_corners(c, m, i), levels - 1, out);
}

// Tiles of 12 levels along the curve, in the middle of the raster.
const std::vector<std::vector<glm::dvec3>>& tiles(const RasterField& field) {
    static std::map<const RasterField*, std::vector<std::vector<glm::dvec3>>> known;
    auto& found = known[&field];
    if (!found.empty()) return found;
    const RasterHeader& r = field.raster();
    const glm::dvec2 middle = r.grid.crs_from_sample(0.5 * glm::dvec2(r.width, r.height));
    const glm::dvec3 n = normal_from_geodetic(middle.y * degrees, middle.x * degrees);
    const double spacing = field.spacing({n, 0});
    int level = 12;
    while (cell_metrics(level).vertex_spacing * 6371000 > spacing) ++level;
    const int root_level = (level / 12 - 1) * 12 + level % 12;
    const std::uint64_t first = cell_at(n, root_level).bits() & ~std::uint64_t{255};
    for (std::uint64_t i = 0; i < 256; ++i) {
        const LocationCode root(first + i);
        found.emplace_back();
        add_vertices(root, corners(root), 12, found.back());
    }
    return found;
}

void per_item(benchmark::State& state, std::size_t items) {
    state.counters["each"] = benchmark::Counter(
        static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void heights(benchmark::State& state, const RasterField& field) {
    const auto& places = tiles(field);
    std::vector<float> h(places[0].size());
    std::size_t answered = 0;
    for (auto _ : state)
        for (const auto& tile : places) {
            field.heights(tile, h);
            answered += std::isnan(h[0]) ? 0 : 1;
            benchmark::DoNotOptimize(h.data());
        }
    state.counters["inside"] = static_cast<double>(answered) / static_cast<double>(state.iterations() * places.size());
    per_item(state, places.size() * places[0].size());
}
void heights_in_blocks(benchmark::State& state) {
    heights(state, *blocked());
}
BENCHMARK(heights_in_blocks);
void heights_in_memory(benchmark::State& state) {
    heights(state, *whole());
}
BENCHMARK(heights_in_memory);

// Where the time goes before any sample is touched: directions to columns and rows.
void positions_alone(benchmark::State& state) {
    const auto& places = tiles(*whole());
    const SampleMap map(whole()->raster());
    std::vector<glm::dvec2> at(places[0].size());
    for (auto _ : state)
        for (const auto& tile : places) {
            map.samples_from_normals(tile, at);
            benchmark::DoNotOptimize(at.data());
        }
    per_item(state, places.size() * places[0].size());
}
BENCHMARK(positions_alone);

std::vector<Cap> caps_of(const RasterField& field) {
    std::vector<Cap> caps;
    for (const auto& tile : tiles(field)) {
        Cap cap{tile[0], 0};
        for (const glm::dvec3& n : tile) cap.angle = std::max(cap.angle, glm::distance(n, tile[0]));
        caps.push_back(cap);
    }
    return caps;
}

void samples_appended(benchmark::State& state) {
    const std::vector<Cap> caps = caps_of(*blocked());
    std::vector<glm::dvec3> n;
    std::vector<float> h;
    std::size_t count = 0;
    for (auto _ : state)
        for (const Cap& cap : caps) {
            n.clear();
            h.clear();
            blocked()->samples(cap, n, h);
            count += n.size();
            benchmark::DoNotOptimize(n.data());
        }
    per_item(state, count / std::max<std::size_t>(1, state.iterations()));
}
BENCHMARK(samples_appended);

void samples_by_rows(benchmark::State& state) {
    const std::vector<Cap> caps = caps_of(*blocked());
    std::size_t count = 0;
    double sum = 0;
    for (auto _ : state)
        for (const Cap& cap : caps)
            blocked()->sample_rows(cap, [&](std::span<const glm::dvec3> n, std::span<const float> h) {
                count += h.size();
                sum += n[0].x + static_cast<double>(h[0]);
            });
    benchmark::DoNotOptimize(sum);
    per_item(state, count / std::max<std::size_t>(1, state.iterations()));
}
BENCHMARK(samples_by_rows);

// Baseline: as many normals and heights copied one by one.
void samples_copied(benchmark::State& state) {
    std::vector<glm::dvec3> from_n(1 << 14), n;
    std::vector<float> from_h(1 << 14), h;
    for (auto _ : state) {
        n.clear();
        h.clear();
        for (std::size_t i = 0; i < from_n.size(); ++i) n.push_back(from_n[i]), h.push_back(from_h[i]);
        benchmark::DoNotOptimize(n.data());
    }
    per_item(state, from_n.size());
}
BENCHMARK(samples_copied);

// A file from closed to ready: every sample read, its bytes hashed, voids found.
void opening_in_blocks(benchmark::State& state) {
    double samples = 0;
    for (auto _ : state) {
        const auto mosaic = std::make_shared<const RasterMosaic>(std::vector{mosaic_part(file())}, "bench");
        const BlockedRaster raster(mosaic, std::make_shared<BlockCache>(std::size_t{64} << 20));
        samples = static_cast<double>(raster.header().count());
    }
    per_item(state, static_cast<std::size_t>(samples));
}
BENCHMARK(opening_in_blocks)->Unit(benchmark::kMillisecond);

// Its baseline: reading all of it into memory, with the same hash.
void reading_whole(benchmark::State& state) {
    double samples = 0;
    for (auto _ : state) samples = static_cast<double>(read_raster(shipped).count());
    per_item(state, static_cast<std::size_t>(samples));
}
BENCHMARK(reading_whole)->Unit(benchmark::kMillisecond);

}  // namespace
