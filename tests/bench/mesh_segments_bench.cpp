// Segments over real heights: data/sangre_de_cristo.tif, baked; K for a million leaves, some half of them in view.
// Baselines: all of them made anew in each frame. Every tile was loaded before.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "planet/bake/bake.h"
#include "planet/elevation/raster_field.h"
#include "planet/elevation/raster_io.h"
#include "planet/frames.h"
#include "planet/mesh/segments.h"
#include "planet/store/store_field.h"
#include "planet/streaming/store_tiles.h"

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

    /// @param height_m above the ground in the middle @param along_m eastwards of it
    glm::dvec3 eye_at(double height_m, double along_m) const {
        const glm::dvec3 n = normal_from_geodetic(latitude, longitude + along_m / (6.371e6 * std::cos(latitude)));
        return ecef_from_normal(wgs84, n, {ground + height_m});
    }

    std::shared_ptr<const ElevationStore> store = [] {
        const auto raster =
            std::make_shared<const Raster>(read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif"));
        return std::make_shared<const ElevationStore>(
            bake_in_memory(RasterField(raster, VerticalDatum::egm96), BakeOptions()));
    }();
    StoreField field{store};
    StoreTiles tiles{field.cache(), {}};
    double ground = static_cast<double>(field.height(normal_from_geodetic(latitude, longitude)));
    SegmentView view;
    Segments segments;
};

/// 1920 x 1080 at 40 degrees, looking eastwards and down by `pitch`.
void look(SegmentView& view, const glm::dvec3& eye, double pitch) {
    const glm::dvec3 up = glm::normalize(eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), up));
    const glm::dvec3 level = glm::normalize(glm::cross(up, right));
    const glm::dvec3 ahead = std::cos(pitch) * level - std::sin(pitch) * up, above = glm::cross(right, ahead);
    const double across = std::tan(20 * degrees), half_down = across * 1080 / 1920;
    view.test.eye = view.culling.eye = eye;
    view.culling.inward = {glm::normalize(across * ahead + right), glm::normalize(across * ahead - right),
                           glm::normalize(half_down * ahead + above), glm::normalize(half_down * ahead - above)};
    view.culling.occluder_radius = wgs84.b - 600;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

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

// The eye moves by so many decimetres a frame, forth and back, so that every tile is loaded before.
void segments_update(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view = s.view;
    const double step = 0.1 * static_cast<double>(state.range(0));
    const int threads = static_cast<int>(state.range(1));
    const bool culled = state.range(2) != 0;
    Segments segments;
    const auto frame = [&](int f) {
        const int there = f % 80 < 40 ? f % 80 : 80 - f % 80;
        const glm::dvec3 eye = s.eye_at(637, step * there);
        view.test.eye = eye;
        if (culled) look(view, eye, 0.15);
        segments.update(s.tiles, view, threads);
    };
    for (int f = 0; f <= 80; ++f) frame(f);
    std::size_t built = 0;
    int f = 0;
    for (auto _ : state) {
        frame(++f);
        built += segments.built();
    }
    report(state, segments);
    state.counters["built"] = static_cast<double>(built) / static_cast<double>(state.iterations());
}
BENCHMARK(segments_update)
    ->ArgNames({"dm", "threads", "culled"})
    ->ArgsProduct({{0, 1, 6, 64}, {1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// The eye at rest, turning: nothing is built but what comes into view for the first time.
void segments_turning(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view = s.view;
    view.kept_leaves = 2'000'000;
    Segments segments;
    double pitch = 0;
    const auto frame = [&] {
        pitch = pitch < 0.6 ? pitch + 0.01 : 0;
        look(view, s.eye_at(637, 0), pitch);
        segments.update(s.tiles, view);
    };
    for (int f = 0; f < 70; ++f) frame();
    for (auto _ : state) frame();
    report(state, segments);
}
BENCHMARK(segments_turning)->Unit(benchmark::kMillisecond);

// Baseline: what each frame above would cost without the frame before.
void segments_from_scratch(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view = s.view;
    if (state.range(1) != 0) look(view, view.test.eye, 0.15);
    Segments segments;
    for (auto _ : state) segments.build(s.tiles, view, static_cast<int>(state.range(0)));
    report(state, segments);
}
BENCHMARK(segments_from_scratch)
    ->ArgNames({"threads", "culled"})
    ->ArgsProduct({{1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// 600 frames from 20,000 km down to 50 m, at half a pixel.
void segments_flight(benchmark::State& state) {
    Scene& s = scene();
    SegmentView view;
    view.test.K = 2.0 * 1080 / (2 * std::tan(11.57 * degrees)) * 1.17;
    const int threads = static_cast<int>(state.range(0));
    const bool anew = state.range(1) != 0;
    Segments segments;
    std::vector<double> times;
    std::size_t most = 0;
    const auto fly = [&] {
        for (int f = 0; f < 600; ++f) {
            const double height = 2e7 * std::pow(50 / 2e7, f / 599.0);
            look(view, s.eye_at(height, -std::min(height, 2e6)), 0.2 + 1.2 * std::min(1.0, height / 2e6));
            const auto start = std::chrono::steady_clock::now();
            if (anew)
                segments.build(s.tiles, view, threads);
            else
                segments.update(s.tiles, view, threads);
            times.push_back(milliseconds_since(start));
            most = std::max(most, segments.leaf_count());
        }
    };
    fly();
    times.clear();
    segments = Segments();
    for (auto _ : state) fly();
    std::sort(times.begin(), times.end());
    state.counters["median_ms"] = times[times.size() / 2];
    state.counters["p99_ms"] = times[times.size() * 99 / 100];
    state.counters["leaves_most"] = static_cast<double>(most);
}
BENCHMARK(segments_flight)
    ->ArgNames({"threads", "anew"})
    ->ArgsProduct({{1, 2}, {0, 1}})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
