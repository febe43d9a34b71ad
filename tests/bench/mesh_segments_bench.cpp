// Segments over real heights: data/sangre_de_cristo.tif, baked, with a million leaves and no culling. Baselines: all
// segments built anew, and the planet as one strip.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "planet/elevation/raster_field.h"
#include "planet/elevation/raster_io.h"
#include "planet/frames.h"
#include "planet/mesh/segments.h"
#include "planet/store/bake.h"
#include "planet/store/store_field.h"
#include "planet/store/store_tiles.h"

namespace {

using namespace planet;

constexpr double latitude = 37.58 * degrees, longitude = -105.49 * degrees;

class Scene {
  public:
    Scene() {
        view.test.eye = eye_at(637, 0);
        const auto leaves = [this](double K) {
            view.test.K = K;
            segments.build(tiles, view, 2);
            return segments.leaf_count();
        };
        double low = 1, high = 2;
        while (leaves(high) < 1'000'000 && high < 1e9) low = high, high *= 2;
        while (high / low > 1.0001) {
            const double middle = std::sqrt(low * high);
            (leaves(middle) < 1'000'000 ? low : high) = middle;
        }
    }

    /// @param height_m above the ground @param along_m eastwards
    glm::dvec3 eye_at(double height_m, double along_m) const {
        const glm::dvec3 n = normal_from_geodetic(latitude, longitude + along_m / (6.371e6 * std::cos(latitude)));
        const glm::dvec3 ground = normal_from_geodetic(latitude, longitude);
        return ecef_from_normal(wgs84, n, {static_cast<double>(field.height(ground)) + height_m});
    }

    std::shared_ptr<const ElevationStore> store = [] {
        const auto raster =
            std::make_shared<const Raster>(read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif"));
        return std::make_shared<const ElevationStore>(
            bake_in_memory(RasterField(raster, VerticalDatum::egm96), BakeOptions()));
    }();
    StoreField field{store};
    StoreTiles tiles{field.cache(), {}};
    SegmentView view;
    Segments segments;
};

Scene& scene() {
    static Scene s;
    return s;
}

void report(benchmark::State& state, const Segments& segments) {
    state.counters["leaves"] = static_cast<double>(segments.leaf_count());
    state.counters["segments"] = static_cast<double>(segments.segments().size());
    state.counters["vertices"] = static_cast<double>(segments.vertex_count());
    state.counters["indices"] = static_cast<double>(segments.index_count());
}

double distance_between_frames(const benchmark::State& state) {
    return 0.1 * static_cast<double>(state.range(0));
}

// The eye moves by so many decimetres a frame.
void segments_update(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view = s.view;
    Segments segments;
    segments.build(s.tiles, view, static_cast<int>(state.range(1)));
    double along = 0;
    std::size_t built = 0;
    for (auto _ : state) {
        along += distance_between_frames(state);
        view.test.eye = s.eye_at(637, along);
        segments.update(s.tiles, view, static_cast<int>(state.range(1)));
        built += segments.built();
    }
    report(state, segments);
    state.counters["built"] = static_cast<double>(built) / static_cast<double>(state.iterations());
}
BENCHMARK(segments_update)
    ->ArgNames({"dm", "threads"})
    ->ArgsProduct({{0, 1, 6, 64, 640}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// The eye at rest, the culling another in each frame.
void segments_turning(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view = s.view;
    Segments segments;
    view.culling.eye = view.test.eye;
    segments.build(s.tiles, view);
    double ball = 1;
    for (auto _ : state) {
        view.culling.occluder_radius = ball += 1;
        segments.update(s.tiles, view);
    }
    report(state, segments);
}
BENCHMARK(segments_turning)->Unit(benchmark::kMillisecond);

// Baseline.
void segments_from_scratch(benchmark::State& state) {
    Scene& s = scene();
    Segments segments;
    for (auto _ : state) segments.build(s.tiles, s.view, static_cast<int>(state.range(0)));
    report(state, segments);
}
BENCHMARK(segments_from_scratch)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
