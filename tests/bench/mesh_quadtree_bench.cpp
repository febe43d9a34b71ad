// Pointerless quadtrees: neighbours, splits with closure, removals of merging domains. The baseline is the same closure
// over std::unordered_set. `per_call` is the time of one neighbour, of one diamond split, of one merged triangle.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <unordered_set>

#include "planet/quadtree/patch_lattice.h"
#include "planet/quadtree/triangulation.h"

namespace {

using namespace planet;

/// What one would write first.
class HashSplitSet {
  public:
    HashSplitSet(int, int levels) : levels_(levels) {}

    int levels() const { return levels_; }
    bool contains(CellCode cell) const { return cells_.contains(cell); }
    Insertion insert(CellCode cell) { return {cells_.insert(cell).second, contains(cell >> 1)}; }
    unsigned drop(CellCode cell) {
        cells_.erase(cell);
        unsigned children = 0;
        for (const unsigned i : {0u, 1u})
            if (contains(2 * cell + i)) {
                children |= 1u << i;
                drop(2 * cell + i);
            }
        return children;
    }

  private:
    int levels_;
    std::unordered_set<CellCode> cells_;
};

void set_per_call(benchmark::State& state, std::size_t calls) {
    state.counters["per_call"] =
        benchmark::Counter(static_cast<double>(calls), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Every level from the first as often, and every cell of a level.
template <Topology T>
std::vector<CellCode> random_cells(const T& topology, int first_level, std::size_t n) {
    std::mt19937_64 random(1);
    std::vector<CellCode> cells;
    while (cells.size() < n) {
        const int level = first_level + static_cast<int>(random() % static_cast<unsigned>(53 - first_level));
        const int rank = static_cast<int>(random() % static_cast<unsigned>(topology.root_count()));
        cells.push_back(topology.root(rank) << level | (random() & ((CellCode{1} << level) - 1)));
    }
    return cells;
}

template <Topology T>
void neighbors(benchmark::State& state, const T& topology, int first_level) {
    const auto cells = random_cells(topology, first_level, 4096);
    std::size_t calls = 0;
    for (auto _ : state) {
        CellCode sum = 0;
        for (const CellCode c : cells) sum += topology.neighbor(c);
        benchmark::DoNotOptimize(sum);
        calls += cells.size();
    }
    set_per_call(state, calls);
}
// Near the roots every other side lies on a border: the branch there is wrong as often as not.
BENCHMARK_CAPTURE(neighbors, octahedron, OctahedronTopology{}, 0);
BENCHMARK_CAPTURE(neighbors, octahedron_from_level_10, OctahedronTopology{}, 10);
BENCHMARK_CAPTURE(neighbors, patch, PatchGrid(1, 1), 0);
BENCHMARK_CAPTURE(neighbors, patches_3x3, PatchGrid(3, 3), 0);
BENCHMARK_CAPTURE(neighbors, patches_3x3_from_level_10, PatchGrid(3, 3), 10);

/// Finest cells along a winding curve, in its order, none twice in a row.
std::vector<CellCode> cells_on_curve(const PatchGrid& grid, int quadtree_levels) {
    const PatchLattice lattice(grid, quadtree_levels);
    std::vector<CellCode> cells;
    const int steps = 1 << 18;
    for (int k = 0; k < steps; ++k) {
        const double t = 2 * std::numbers::pi * k / steps;
        const glm::ivec2 at((0.5 + 0.45 * std::sin(5 * t)) * (lattice.width() - 1),
                            (0.5 + 0.45 * std::cos(7 * t)) * (lattice.height() - 1));
        const auto cell = lattice.cell_split_at(at | 1);
        if (cell && (cells.empty() || cells.back() != *cell)) cells.push_back(*cell);
    }
    return cells;
}

/// Refines towards a curve, to 0.9 million leaves.
template <class Set>
void split_along_curve(benchmark::State& state) {
    constexpr int quadtree_levels = 13;
    const PatchGrid grid(1, 1);
    const auto cells = cells_on_curve(grid, quadtree_levels);
    std::size_t splits = 0, leaves = 0;
    for (auto _ : state) {
        state.PauseTiming();
        Triangulation<PatchGrid, Set> t(grid, 2 * quadtree_levels);
        state.ResumeTiming();
        for (const CellCode cell : cells) splits += static_cast<std::size_t>(t.split(cell));
        state.PauseTiming();
        leaves = 0;
        t.for_each_leaf([&](CellCode) { ++leaves; });
        state.ResumeTiming();
    }
    set_per_call(state, splits);
    state.counters["leaves"] = static_cast<double>(leaves);
}
BENCHMARK(split_along_curve<DenseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(split_along_curve<SparseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(split_along_curve<HashSplitSet>)->Unit(benchmark::kMillisecond);

/// Refines one quarter of a face of the octahedron to its last level, in random order: half a million leaves.
template <class Set>
void split_region(benchmark::State& state) {
    constexpr int levels = 20;
    std::vector<CellCode> cells;
    const CellCode first = CellCode{0b1000011} << (levels - 4);
    for (CellCode c = first; c < first + (1 << 18); ++c) cells.push_back(c);
    std::shuffle(cells.begin(), cells.end(), std::mt19937_64(1));
    std::size_t splits = 0, leaves = 0;
    for (auto _ : state) {
        state.PauseTiming();
        Triangulation<OctahedronTopology, Set> t({}, levels);
        state.ResumeTiming();
        for (const CellCode cell : cells) splits += static_cast<std::size_t>(t.split(cell));
        state.PauseTiming();
        leaves = 0;
        t.for_each_leaf([&](CellCode) { ++leaves; });
        state.ResumeTiming();
    }
    set_per_call(state, splits);
    state.counters["leaves"] = static_cast<double>(leaves);
}
BENCHMARK(split_region<DenseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(split_region<SparseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(split_region<HashSplitSet>)->Unit(benchmark::kMillisecond);

template <class Set>
Triangulation<PatchGrid, Set> full_mesh(int quadtree_levels) {
    Triangulation<PatchGrid, Set> t(PatchGrid(3, 3), 2 * quadtree_levels);
    for (int rank = 0; rank < t.topology().root_count(); ++rank)
        for (int level = 0; level < t.levels(); ++level)
            for (CellCode c = t.topology().root(rank) << level; c < (t.topology().root(rank) + 1) << level; ++c)
                t.split_cells().insert(c);
    return t;
}

/// 100,000 random vertices of a full mesh of 1.2 million triangles, one after the other: what is gone already is cheap.
template <class Set>
void remove_at_random(benchmark::State& state) {
    constexpr int quadtree_levels = 8;
    const auto full = full_mesh<Set>(quadtree_levels);
    const PatchLattice lattice(full.topology(), quadtree_levels);
    std::mt19937_64 random(1);
    std::vector<CellCode> cells;
    while (cells.size() < 100'000) {
        const glm::ivec2 at(random() % static_cast<unsigned>(lattice.width()),
                            random() % static_cast<unsigned>(lattice.height()));
        if (const auto cell = lattice.cell_split_at(at); cell) cells.push_back(*cell);
    }
    std::size_t visited = 0;
    for (auto _ : state) {
        state.PauseTiming();
        auto t = full;
        state.ResumeTiming();
        for (const CellCode cell : cells) visited += t.remove(cell);
    }
    set_per_call(state, visited);
}
BENCHMARK(remove_at_random<DenseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(remove_at_random<SparseSplitSet>)->Unit(benchmark::kMillisecond);
BENCHMARK(remove_at_random<HashSplitSet>)->Unit(benchmark::kMillisecond);

/// The worst case: the centre of the middle patch.
template <class Set>
void remove_centre(benchmark::State& state) {
    const int quadtree_levels = static_cast<int>(state.range(0));
    const auto full = full_mesh<Set>(quadtree_levels);
    std::size_t visited = 0;
    auto t = full;
    for (auto _ : state) {
        state.PauseTiming();
        t = full;
        state.ResumeTiming();
        visited += t.remove(full.topology().root_of_patch(1, 1, 0));
    }
    set_per_call(state, visited);
}
BENCHMARK(remove_centre<DenseSplitSet>)->Arg(5)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);
BENCHMARK(remove_centre<SparseSplitSet>)->Arg(5)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);

}  // namespace
