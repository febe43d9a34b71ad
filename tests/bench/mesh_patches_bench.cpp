// Meshes of rasters, step by step: deviations, refinement, extraction, placing, measuring; 4097 x 4097 samples at 20 m.
// `per_...` is processor time, summed over the threads. Baselines are in the same run.

#include <benchmark/benchmark.h>

#include <cstring>

#include "mirrored_raster.h"
#include "planet/patches/patch_measure.h"

namespace {

using namespace planet;
using namespace planet::bench;

void set_per(benchmark::State& state, const char* what, std::size_t count) {
    state.counters[what] = benchmark::Counter(
        static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

std::size_t sample_count() {
    return terrain().source->count();
}

// ---- deviations ----

void deviations_exact(benchmark::State& state) {
    const Terrain& t = terrain();
    for (auto _ : state) {
        const auto deviation = patch_deviations(t.raster, static_cast<unsigned>(state.range(0)));
        benchmark::DoNotOptimize(deviation.level(0).data());
    }
    set_per(state, "per_sample", sample_count());
}
BENCHMARK(deviations_exact)->ArgName("threads")->Arg(1)->Arg(2)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

// What most RTIN meshers do: the distance at the split vertex only, and the largest of those below it. By split vertex, so
// that both cells of a diamond are one; the levels in turn from the finest.
class SplitVertexDeviations {
  public:
    explicit SplitVertexDeviations(const PatchRaster& raster)
        : raster_(raster),
          size_(raster.width()),
          value_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {
        for (int half = 1; half < size_ - 1; half *= 2) {
            for (int y = 0; y < size_; y += half)
                for (int x = (y / half & 1) ? 0 : half; x < size_; x += 2 * half)
                    (y / half & 1) ? upright(x, y, half) : level(x, y, half);
            for (int y = half; y < size_; y += 2 * half)
                for (int x = half; x < size_; x += 2 * half) diagonal(x, y, half);
        }
    }
    const float* data() const { return value_.data(); }

  private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x);
    }
    float below(int x, int y) const { return x >= 0 && y >= 0 && x < size_ && y < size_ ? value_[index(x, y)] : 0; }
    void set(int x, int y, int dx, int dy, float worst_below) {
        const float middle = (raster_.row(y - dy)[x - dx] + raster_.row(y + dy)[x + dx]) / 2;
        value_[index(x, y)] = std::max(std::abs(middle - raster_.row(y)[x]), worst_below);
    }
    float legs(int x, int y, int half) const {
        const int q = half / 2;
        if (q == 0) return 0;
        return std::max({below(x - q, y - q), below(x + q, y - q), below(x - q, y + q), below(x + q, y + q)});
    }
    void level(int x, int y, int half) { set(x, y, half, 0, legs(x, y, half)); }
    void upright(int x, int y, int half) { set(x, y, 0, half, legs(x, y, half)); }
    void diagonal(int x, int y, int half) {
        const float worst = std::max({below(x - half, y), below(x + half, y), below(x, y - half), below(x, y + half)});
        const bool rises = (x / half & 2) == (y / half & 2);
        set(x, y, half, rises ? half : -half, worst);
    }

    const PatchRaster& raster_;
    int size_;
    std::vector<float> value_;
};

void deviations_at_split_vertices_only(benchmark::State& state) {
    const Terrain& t = terrain();
    for (auto _ : state) {
        const SplitVertexDeviations deviations(t.raster);
        benchmark::DoNotOptimize(deviations.data());
    }
    set_per(state, "per_sample", sample_count());
}
BENCHMARK(deviations_at_split_vertices_only)->Unit(benchmark::kMillisecond);

// Two cells a sample: what any pass must read and write.
void deviations_copied(benchmark::State& state) {
    const Terrain& t = terrain();
    const std::size_t samples = sample_count();
    for (auto _ : state) {
        const auto out = std::make_unique_for_overwrite<float[]>(2 * samples);
        std::memcpy(out.get(), t.raster.row(0), samples * sizeof(float));
        std::memcpy(out.get() + samples, t.raster.row(0), samples * sizeof(float));
        benchmark::DoNotOptimize(out.get());
        benchmark::ClobberMemory();
    }
    set_per(state, "per_sample", samples);
}
BENCHMARK(deviations_copied)->Unit(benchmark::kMillisecond);

// ---- refinement ----

// Diamonds: each split adds one vertex.
std::size_t split_count(const PatchTriangulation& mesh) {
    std::size_t splits = 0;
    for (int rank = 0; rank < mesh.topology().root_count(); ++rank)
        mesh.for_each_split_below(mesh.topology().root(rank),
                                  [&](CellCode cell) { splits += diamond(mesh.topology(), cell) == cell; });
    return splits;
}

void refine_to_20_m(benchmark::State& state) {
    const Terrain& t = terrain();
    for (auto _ : state) {
        state.PauseTiming();
        PatchTriangulation mesh = coarsest(t.raster);
        state.ResumeTiming();
        refine_to_tolerance(mesh, t.deviation, bench_tolerance);
        benchmark::DoNotOptimize(mesh);
    }
    const std::size_t splits = split_count(t.refined(bench_tolerance));
    set_per(state, "per_split", splits);
    state.counters["splits"] = static_cast<double>(splits);
}
BENCHMARK(refine_to_20_m)->Unit(benchmark::kMillisecond);

// Baseline: finding the leaves, where they are known.
void walk_leaves_at_20_m(benchmark::State& state) {
    const PatchTriangulation mesh = terrain().refined(bench_tolerance);
    std::size_t leaves = 0;
    for (auto _ : state) {
        leaves = 0;
        mesh.for_each_leaf([&](CellCode leaf) { benchmark::DoNotOptimize(leaves += leaf != 0); });
    }
    set_per(state, "per_split", split_count(mesh));
    set_per(state, "per_triangle", leaves);
}
BENCHMARK(walk_leaves_at_20_m)->Unit(benchmark::kMillisecond);

// ---- extraction ----

void extract_at_20_m(benchmark::State& state) {
    const Terrain& t = terrain();
    const PatchTriangulation mesh = t.refined(bench_tolerance);
    std::size_t triangles = 0;
    for (auto _ : state) {
        const PatchMesh out = extract(mesh, t.raster);
        triangles = out.triangles.size();
        benchmark::DoNotOptimize(out.strip.data());
    }
    set_per(state, "per_triangle", triangles);
    state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(extract_at_20_m)->Unit(benchmark::kMillisecond);

// A raster that fills no patch, as most: padding is left out, and what crosses the border cut.
void extract_with_padding_at_20_m(benchmark::State& state) {
    const PatchRaster raster(mirrored_raster(4000));
    PatchTriangulation mesh = coarsest(raster);
    refine_to_tolerance(mesh, patch_deviations(raster), bench_tolerance);
    std::size_t triangles = 0;
    for (auto _ : state) {
        const PatchMesh out = extract(mesh, raster);
        triangles = out.triangles.size();
        benchmark::DoNotOptimize(out.strip.data());
    }
    set_per(state, "per_triangle", triangles);
    state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(extract_with_padding_at_20_m)->Unit(benchmark::kMillisecond);

// Baseline: the same bytes.
void copy_extracted_at_20_m(benchmark::State& state) {
    const Terrain& t = terrain();
    const PatchMesh mesh = extract(t.refined(bench_tolerance), t.raster);
    for (auto _ : state) {
        const PatchMesh copy = mesh;
        benchmark::DoNotOptimize(copy.strip.data());
    }
    set_per(state, "per_triangle", mesh.triangles.size());
}
BENCHMARK(copy_extracted_at_20_m)->Unit(benchmark::kMillisecond);

// ---- placing and measuring ----

void place_vertices_in(benchmark::State& state, MeshFrame frame) {
    const Terrain& t = terrain();
    const PatchMesh mesh = extract(t.refined(bench_tolerance), t.raster);
    const RasterFrame placing(t.source, frame, VerticalDatum::ellipsoid, nullptr);
    for (auto _ : state) benchmark::DoNotOptimize(place_vertices(mesh, placing).data());
    set_per(state, "per_vertex", mesh.vertices.size());
}
BENCHMARK_CAPTURE(place_vertices_in, source, MeshFrame::source)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(place_vertices_in, ecef, MeshFrame::ecef)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

void measure_at_20_m(benchmark::State& state) {
    const Terrain& t = terrain();
    const PatchMesh mesh = extract(t.refined(bench_tolerance), t.raster);
    const RasterFrame frame(t.source, MeshFrame::source, VerticalDatum::ellipsoid, nullptr);
    const std::vector<glm::dvec3> written = place_vertices(mesh, frame);
    double max = 0;
    for (auto _ : state) max = measure(mesh, written, t.raster, frame, nullptr).max;
    set_per(state, "per_sample", sample_count());
    set_per(state, "per_triangle", mesh.triangles.size());
    state.counters["max_m"] = max;
}
BENCHMARK(measure_at_20_m)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

// Baseline: one look at every sample, against the same plane.
void measure_against_one_plane(benchmark::State& state) {
    const Terrain& t = terrain();
    for (auto _ : state) {
        float worst = 0;
        double squares = 0;
        for (int y = 0; y < t.raster.height(); ++y)
            for (int x = 0; x < t.raster.width(); ++x) {
                const float d = std::abs(2000 - t.raster.row(y)[x]);
                worst = std::max(worst, d);
                squares += static_cast<double>(d) * static_cast<double>(d);
            }
        benchmark::DoNotOptimize(worst);
        benchmark::DoNotOptimize(squares);
    }
    set_per(state, "per_sample", sample_count());
}
BENCHMARK(measure_against_one_plane)->Unit(benchmark::kMillisecond);

}  // namespace
