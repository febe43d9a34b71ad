// Longest-side bisection, longest first, against std::priority_queue in the same run; the decoding of split records. Times
// are of the processor.

#include <benchmark/benchmark.h>

#include <map>
#include <queue>

#include "mirrored_raster.h"
#include "planet/bisection/leaf_mesh.h"
#include "planet/bisection/progressive_file.h"
#include "planet/tin/make_tin.h"

namespace {

using namespace planet;
using namespace planet::bench;

constexpr std::size_t wanted = 1'000'000;

// A TIN of real terrain: its triangles are of all shapes and of sizes that differ by a factor of 300. In plan, metres.
const PlainMesh& tin() {
    static const PlainMesh mesh = [] {
        TinOptions options;
        options.tolerance = 50;
        const TinMesh tin = make_tin(HeightGrid(mirrored_raster(2049)), options).mesh;
        PlainMesh out;
        for (std::size_t v = 0; v < tin.vertices.size(); ++v)
            out.vertices.emplace_back(tin.vertices[v].x * 73., tin.vertices[v].y * 92., tin.height[v]);
        out.triangles = tin.triangles;
        return out;
    }();
    return mesh;
}

void set_counters(benchmark::State& state, std::size_t splits, std::size_t triangles) {
    state.counters["splits"] = static_cast<double>(splits);
    state.counters["triangles"] = static_cast<double>(triangles);
    state.counters["splits_a_second"] =
        benchmark::Counter(static_cast<double>(splits), benchmark::Counter::kIsIterationInvariantRate);
}

// To a million triangles.
void longest_first(benchmark::State& state, BisectionRule rule) {
    RefineGoal goal;
    goal.max_triangles = wanted;
    std::size_t splits = 0, bytes = 0, triangles = 0;
    for (auto _ : state) {
        state.PauseTiming();
        Bisection mesh(tin(), {rule, SideGeometry::space, {}});
        state.ResumeTiming();
        splits = mesh.refine(goal).splits;
        state.PauseTiming();
        triangles = mesh.triangle_count();
        bytes = mesh.bytes();
        state.ResumeTiming();
    }
    set_counters(state, splits, triangles);
    state.counters["bytes_a_triangle"] = static_cast<double>(bytes) / static_cast<double>(triangles);
}
BENCHMARK_CAPTURE(longest_first, modified, BisectionRule::modified)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(longest_first, plain, BisectionRule::plain)->Unit(benchmark::kMillisecond);

// From a million triangles on to two.
void longest_first_from_a_million(benchmark::State& state) {
    RefineGoal to_one, to_two;
    to_one.max_triangles = wanted;
    to_two.max_triangles = 2 * wanted;
    std::size_t splits = 0;
    for (auto _ : state) {
        state.PauseTiming();
        Bisection mesh(tin());
        mesh.refine(to_one);
        state.ResumeTiming();
        splits = mesh.refine(to_two).splits;
    }
    set_counters(state, splits, 2 * wanted);
}
BENCHMARK(longest_first_from_a_million)->Unit(benchmark::kMillisecond);

// The same splits, leaves waiting in a std::priority_queue.
void longest_first_by_priority_queue(benchmark::State& state) {
    using Waiting = std::pair<double, LeafMesh::Index>;
    std::size_t splits = 0;
    for (auto _ : state) {
        state.PauseTiming();
        LeafMesh mesh(tin(), {});
        mesh.reserve(wanted);
        state.ResumeTiming();
        splits = 0;
        std::priority_queue<Waiting> queue;
        for (LeafMesh::Index t = 0; t < mesh.size(); ++t) queue.emplace(mesh[t].squared[0], t);
        while (mesh.size() + 2 <= wanted) {
            const auto [squared, leaf] = queue.top();
            if (mesh[leaf].squared[0] != squared) {
                queue.pop();
                continue;
            }
            mesh.split_terminal(mesh.terminal(leaf));
            ++splits;
            for (const LeafMesh::Index t : mesh.changed()) queue.emplace(mesh[t].squared[0], t);
        }
    }
    set_counters(state, splits, wanted);
}
BENCHMARK(longest_first_by_priority_queue)->Unit(benchmark::kMillisecond);

// ---- files ----

void decode(benchmark::State& state, double quantum) {
    BisectionOptions options;
    options.sides = SideGeometry::plan;
    if (quantum != 0)
        options.place = [](const glm::dvec3& a, const glm::dvec3& b) {
            const glm::dvec3 p = (a + b) * 0.5;
            return glm::dvec3(p.x, p.y, p.z + 10 * std::sin(p.x * 0.01));
        };
    Bisection mesh(tin(), options);
    RefineGoal goal;
    goal.max_triangles = 2 * wanted;
    mesh.refine(goal);
    const Progressive whole = mesh.progressive();
    const auto bytes = encode_progressive(whole, {quantum});
    for (auto _ : state) benchmark::DoNotOptimize(decode_progressive(bytes, "bench").vertex_count());
    state.counters["vertices_a_second"] =
        benchmark::Counter(whole.split_count(), benchmark::Counter::kIsIterationInvariantRate);
    const std::size_t base = encode_progressive(Progressive(whole.base(), whole.rule(), whole.sides())).size();
    state.counters["bytes_a_vertex"] = static_cast<double>(bytes.size() - base) / whole.split_count();
}
BENCHMARK_CAPTURE(decode, midpoints, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode, placed, 1. / 256)->Unit(benchmark::kMillisecond);

}  // namespace
