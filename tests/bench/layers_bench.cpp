// What layers cost a view that moves: a flight around Blanca Peak as the window draws it, 1280 x 720 with one sample a
// pixel, each frame drawn with the layers and without, in turns, with glFinish. Processor time of llvmpipe, compared by the
// medians. Of the real Earth, so OCTAGLOBE_DATA must name its data; the store and the imagery are those of the user's cache.

#include <benchmark/benchmark.h>
#include <stdlib.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "planet/geodesy/sun.h"
#include "render/app/mesh/mesh_options.h"
#include "render/app/view/globe_data.h"
#include "render/app/view/live_mesh.h"
#include "render/app/view/view_frame.h"
#include "render/gl/context.h"

namespace {

using namespace render;
using planet::degrees;

/// Files of layers, gone in the end.
class LayerFiles {
  public:
    LayerFiles() {
        std::string name = (std::filesystem::temp_directory_path() / "layers_bench_XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        folder_ = name;
        write_track(10'000);
        write_plots(30);
        MeshOptions mesh;
        mesh.source = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";
        mesh.max_deviation = 20;
        mesh.output = folder_ / "mesh.glb";
        Report report("mesh", "");
        mesh_raster(mesh, report);
    }
    ~LayerFiles() { std::filesystem::remove_all(folder_); }
    LayerFiles(const LayerFiles&) = delete;
    LayerFiles& operator=(const LayerFiles&) = delete;
    std::filesystem::path operator/(const char* name) const { return folder_ / name; }

  private:
    /// Zigzags over the mountains, 20 m from vertex to vertex.
    void write_track(int vertices) const {
        std::ofstream file(folder_ / "track.geojson");
        file.precision(12);
        file << R"({"type":"LineString","coordinates":[)";
        for (int i = 0; i < vertices; ++i)
            file << (i > 0 ? "," : "") << '[' << -105.6 + 0.2 * i / vertices << ','
                 << 37.58 + 0.07 * std::asin(std::sin(0.01 * i)) << ']';
        file << "]}";
    }
    /// A square of squares, each with a name.
    void write_plots(int side) const {
        std::ofstream file(folder_ / "plots.geojson");
        file.precision(12);
        file << R"({"type":"FeatureCollection","features":[)";
        for (int i = 0; i < side * side; ++i) {
            const double x = -105.6 + 0.008 * (i % side), y = 37.48 + 0.008 * (i / side), w = 0.006;
            file << (i > 0 ? "," : "") << R"({"type":"Feature","properties":{"name":"Plot )" << i
                 << R"("},"geometry":{"type":"Polygon","coordinates":[[)";
            for (const auto& [dx, dy] : {std::pair(0.0, 0.0), {w, 0.0}, {w, w}, {0.0, w}})
                file << '[' << x + dx << ',' << y + dy << "],";
            file << '[' << x << ',' << y << "]]]}}";
        }
        file << "]}";
    }

    std::filesystem::path folder_;
};

RenderOptions options_with(const std::vector<LayerOptions>& layers) {
    RenderOptions options;
    options.size = {1280, 720};
    options.layers = layers;
    return options;
}

/// Of all threads: the pictures are drawn by the processor, and other work on the machine does not count.
double process_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class MovingView {
  public:
    explicit MovingView(const std::vector<LayerOptions>& layers)
        : options_(options_with(layers)), data_(GlobeLoading(options_).take()), mesh_(options_, *data_.surface, 2048) {
        looks_.upload(data_.imagery);
        looks_.link(data_.stars, data_.noise, {});
        set_reversed_depth();
        const AtmosphereTables tables = make_tables();
        looks_.set_sky(
            tables,
            make_view_table(tables, camera(0).eye, planet::sun_direction(options_.time), options_.thread_count()),
            options_.time);
    }

    /// Half a degree a frame, from 12 km.
    Camera camera(int frame) const {
        RenderOptions view = options_;
        view.at = {37.58 * degrees, -105.49 * degrees, {}};
        view.range = 12'000;
        view.heading = 0.5 * frame * degrees;
        view.pitch = -20 * degrees;
        return data_.surface->camera(view);
    }
    /// The mesh of a frame. @return it moved on
    void move_to(int frame) {
        now_ = camera(frame);
        const bool changed = mesh_.update({.camera = now_});
        mesh_.update_patches(changed, 24);
        looks_.terrain().upload(mesh_.segments(), mesh_.patches().layers());
    }
    void settle() { mesh_.settle({.camera = camera(0)}); }
    /// Seconds of drawing it, names included.
    double draw(bool layers) {
        looks_.set_layers(layers ? data_.layers.shown(options_) : std::vector<const Layer*>{}, true);
        const PicturePart whole{0, 0, now_.width, now_.height};
        DrapeGround ground = data_.surface->for_layers(mesh_.segments(), now_, whole, 1);
        const double start = process_seconds();
        frame_.draw_moving(looks_,
                           {.camera = now_,
                            .part = whole,
                            .patches = mesh_.patches().texture(),
                            .ground = ground,
                            .morph_reach = mesh_.morph_reach()},
                           1);
        looks_.draw_labels(now_, whole, ground, 1);
        gl().Finish();
        return process_seconds() - start;
    }

  private:
    RenderOptions options_;
    Context context_ = Context::create({});
    GlobeData data_;
    GlobeLooks looks_;
    LiveMesh mesh_;
    ViewFrame frame_;
    Camera now_;
};

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

void moving_view(benchmark::State& state, const std::vector<const char*>& texts) {
    static const LayerFiles files;
    std::vector<LayerOptions> layers;
    for (const char* text : texts) layers.push_back(parse_layer("layer", (files / text).string()));
    MovingView view(layers);
    view.settle();
    std::vector<double> with, without;
    int frame = 0;
    for (auto _ : state) {
        view.move_to(frame++);
        const bool first = frame % 2 == 0;  // either of the two finds the caches as the other left them
        for (const bool layered : {first, !first}) (layered ? with : without).push_back(view.draw(layered));
        state.SetIterationTime(with.back());
    }
    state.counters["with_ms"] = 1e3 * median(with);
    state.counters["without_ms"] = 1e3 * median(without);
    state.counters["ratio"] = median(with) / median(without);
}

void add(const char* name, const std::vector<const char*>& layers) {
    benchmark::RegisterBenchmark(name, [layers](benchmark::State& state) { moving_view(state, layers); })
        ->Iterations(15)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    add("moving_view/nothing", {});
    add("moving_view/track", {"track.geojson,width=3"});
    add("moving_view/polygons", {"plots.geojson,fill=0.3"});
    add("moving_view/polygons_and_names", {"plots.geojson,fill=0.3,label=name"});
    add("moving_view/mesh", {"mesh.glb"});
    add("moving_view/all", {"mesh.glb,opacity=0.7", "plots.geojson,fill=0.3,label=name", "track.geojson,width=3"});
    benchmark::RunSpecifiedBenchmarks();
}
