// Unique vertices and a strip out of the walk, against a reorder pass over a list whose unique vertices are given.
//
//   walk_ms, reorder_ms      processor time, the best of all iterations, which alternate
//   ratio                    reorder_ms / walk_ms
//   acmr, reordered_acmr     misses a triangle of a FIFO of 32 vertices
//   indices, stripified      indices a triangle of one strip: ours, and meshoptimizer's of its own order

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <random>

#include "ball_tiles.h"
#include "mirrored_raster.h"
#include "planet/frames.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/smooth_ellipsoid.h"

#ifdef OCTAGLOBE_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace {

using namespace planet;
using namespace planet::bench;
using Triangle = std::array<std::uint32_t, 3>;

double processor_seconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A list of triangles, its unique vertices numbered 0 .. vertices - 1, and how many indices its strip has.
struct ListMesh {
    std::vector<Triangle> triangles;
    std::size_t vertices = 0, strip = 0;
};

double per_triangle(std::size_t n, const ListMesh& mesh) {
    return static_cast<double>(n) / static_cast<double>(mesh.triangles.size());
}

/// Misses of a first-in, first-out cache of 32 vertices.
std::size_t fifo32_misses(const std::vector<Triangle>& triangles, std::size_t vertices) {
    constexpr std::size_t size = 32;
    std::vector<std::size_t> loaded(vertices, 0);  // by vertex: the number of the miss that loaded it, from 1
    std::size_t misses = 0;
    for (const Triangle& t : triangles)
        for (const std::uint32_t v : t)
            if (loaded[v] == 0 || misses - loaded[v] >= size) loaded[v] = ++misses;
    return misses;
}

/// Triangles of a strip; two equal indices are only a turn.
ListMesh list_of_strip(std::span<const std::uint32_t> strip, std::size_t vertices) {
    ListMesh list{{}, vertices, strip.size()};
    for (std::size_t i = 2; i < strip.size(); ++i) {
        const Triangle t{strip[i - 2 + i % 2], strip[i - 1 - i % 2], strip[i]};
        if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) list.triangles.push_back(t);
    }
    return list;
}

enum class Given { random_order, row_order };

/// What a reorder pass is given. `row_key` by vertex: rows from one side to the other, as rasters are read; vertices and
/// triangles are sorted by it. In random order vertices keep the walk's numbers.
template <class RowKey>
std::vector<Triangle> shuffled(const ListMesh& mesh, Given order, RowKey&& row_key) {
    std::vector<Triangle> list = mesh.triangles;
    if (order == Given::random_order) {
        std::shuffle(list.begin(), list.end(), std::mt19937(1));
        return list;
    }
    std::vector<std::uint32_t> by_row(mesh.vertices), rank(mesh.vertices);
    for (std::uint32_t v = 0; v < by_row.size(); ++v) by_row[v] = v;
    std::sort(by_row.begin(), by_row.end(), [&](std::uint32_t a, std::uint32_t b) { return row_key(a) < row_key(b); });
    for (std::uint32_t i = 0; i < by_row.size(); ++i) rank[by_row[i]] = i;
    for (Triangle& t : list)
        for (std::uint32_t& v : t) v = rank[v];
    const auto first = [](const Triangle& t) { return std::min({t[0], t[1], t[2]}); };
    std::sort(list.begin(), list.end(), [&](const Triangle& a, const Triangle& b) { return first(a) < first(b); });
    return list;
}

#ifdef OCTAGLOBE_HAS_MESHOPTIMIZER
class Reorder {
  public:
    Reorder(const std::vector<Triangle>& list, std::size_t vertices)
        : list_(list), vertices_(vertices), out_(list.size()) {}

    void run() { meshopt_optimizeVertexCache(out_[0].data(), list_[0].data(), 3 * list_.size(), vertices_); }

    void report(benchmark::State& state, double seconds, double walk_seconds, const ListMesh& ours) const {
        state.counters["reorder_ms"] = 1e3 * seconds;
        state.counters["ratio"] = seconds / walk_seconds;
        state.counters["reordered_acmr"] = per_triangle(fifo32_misses(out_, vertices_), ours);
        std::vector<std::uint32_t> strip(meshopt_stripifyBound(3 * out_.size()));
        const std::size_t length = meshopt_stripify(strip.data(), out_[0].data(), 3 * out_.size(), vertices_, ~0u);
        state.counters["stripified"] = per_triangle(length, ours);
    }

  private:
    const std::vector<Triangle>& list_;
    std::size_t vertices_;
    std::vector<Triangle> out_;
};
#else
struct Reorder {
    Reorder(const std::vector<Triangle>&, std::size_t) {}
    void run() {}
    void report(benchmark::State&, double, double, const ListMesh&) const {}
};
#endif

/// @param walk makes vertices, strip and whatever else is ours @param mesh what it makes
template <class Walk>
void compare(benchmark::State& state, Walk&& walk, const ListMesh& mesh, const std::vector<Triangle>& given) {
    Reorder reorder(given, mesh.vertices);
    double walk_seconds = 1e9, reorder_seconds = 1e9;
    const auto seconds = [](auto&& work) {
        const double start = processor_seconds();
        work();
        return processor_seconds() - start;
    };
    for (auto _ : state) {
        const double s = seconds(walk);
        state.SetIterationTime(s);
        walk_seconds = std::min(walk_seconds, s);
        reorder_seconds = std::min(reorder_seconds, seconds([&] { reorder.run(); }));
    }
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
    state.counters["walk_ms"] = 1e3 * walk_seconds;
    state.counters["acmr"] = per_triangle(fifo32_misses(mesh.triangles, mesh.vertices), mesh);
    state.counters["indices"] = per_triangle(mesh.strip, mesh);
    reorder.report(state, reorder_seconds, walk_seconds, mesh);
}

// ---- rasters: list, strip and vertices from one walk ----

void compare_triangulation(benchmark::State& state, const PatchTriangulation& mesh, Given order) {
    const PatchRaster& raster = terrain().raster;
    ListMesh list;
    std::vector<Triangle> given;
    {
        const PatchMesh out = extract(mesh, raster);
        list = {out.triangles, out.vertices.size(), out.strip.size()};
        given = shuffled(list, order, [&](std::uint32_t v) {
            return static_cast<std::int64_t>(out.vertices[v].at.y) << 32 | out.vertices[v].at.x;
        });
    }
    compare(
        state, [&] { benchmark::DoNotOptimize(extract(mesh, raster).strip.data()); }, list, given);
}

void raster_at_20_m(benchmark::State& state, Given order) {
    compare_triangulation(state, terrain().refined(bench_tolerance), order);
}

/// The tolerance of about a million triangles.
double tolerance_of_a_million() {
    double low = 1, high = 1000;
    while (high / low > 1.001) {
        const double middle = std::sqrt(low * high);
        std::size_t leaves = 0;
        terrain().refined(middle).for_each_leaf([&](CellCode) { ++leaves; });
        (leaves > 1'000'000 ? low : high) = middle;
    }
    return high;
}

void raster_of_a_million(benchmark::State& state, Given order) {
    static const double tolerance = tolerance_of_a_million();
    compare_triangulation(state, terrain().refined(tolerance), order);
    state.counters["tolerance_m"] = tolerance;
}

void raster_uniform(benchmark::State& state, Given order) {
    PatchTriangulation mesh = coarsest(terrain().raster);
    refine_to_level(mesh, 19);
    compare_triangulation(state, mesh, order);
}

// ---- the planet: strip and vertices from one walk ----

/// Rough ground, seen from 637 m: about a million leaves.
struct PlanetScene {
    testing::BallTiles tiles{40, 0.02};
    SplitTest test{ecef_from_normal(wgs84, normal_from_geodetic(0.65, -1.84), {637.0}), 0};

    PlanetScene() {
        double low = 1, high = 1 << 20;
        SmoothEllipsoid mesh(wgs84);
        while (high / low > 1.0001) {
            test.K = std::sqrt(low * high);
            mesh.refine(tiles.bounds(), test.eye, test.K);
            (mesh.triangles() < 1'000'000 ? low : high) = test.K;
        }
    }
};

template <class Mesh>
void compare_planet(benchmark::State& state, const Mesh& mesh, Given order, auto&& refine) {
    refine();
    const ListMesh list = list_of_strip(mesh.strip(), mesh.vertices().size());
    const auto given = shuffled(list, order, [&](std::uint32_t v) {
        const GridPosition& p = mesh.vertices()[v];
        return std::pair(static_cast<std::int32_t>(p.z), static_cast<std::int32_t>(p.x));
    });
    compare(state, refine, list, given);
}

void planet_of_tiles(benchmark::State& state, Given order) {
    static PlanetScene scene;
    StripMesh mesh;
    compare_planet(state, mesh, order, [&] { mesh.refine(scene.tiles, scene.test); });
}

void smooth_planet(benchmark::State& state, Given order) {
    static PlanetScene scene;
    const auto bounds = scene.tiles.bounds();
    SmoothEllipsoid mesh(wgs84);
    compare_planet(state, mesh, order, [&] { mesh.refine(bounds, scene.test.eye, scene.test.K); });
}

void smooth_planet_uniform(benchmark::State& state, Given order) {
    SmoothEllipsoid mesh(wgs84);
    compare_planet(state, mesh, order, [&] { mesh.refine_to_level(17); });
}

#define COMPARE(name)                                    \
    BENCHMARK_CAPTURE(name, random, Given::random_order) \
        ->Iterations(7)                                  \
        ->UseManualTime()                                \
        ->Unit(benchmark::kMillisecond);                 \
    BENCHMARK_CAPTURE(name, rows, Given::row_order)->Iterations(7)->UseManualTime()->Unit(benchmark::kMillisecond)
COMPARE(raster_at_20_m);
COMPARE(raster_of_a_million);
COMPARE(raster_uniform);
COMPARE(planet_of_tiles);
COMPARE(smooth_planet);
COMPARE(smooth_planet_uniform);

}  // namespace
