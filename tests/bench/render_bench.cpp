// What of the frames of a flight the mesh takes, and what is sent to the GPU. And the terrain pass against its baseline:
// the same triangles, vertices, textures and shaders as one static indexed list.
// Of the real Earth, so OCTAGLOBE_DATA must name its data; the store and the imagery are those of the user's cache. The
// two are drawn in turns, each with glFinish and a clock (GL timers are unreliable in software), and compared by the
// medians of their times: other work on the machine then hits both alike.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <thread>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/sun.h"
#include "planet/mesh/segments.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/store/store_field.h"
#include "planet/streaming/mesh_ahead.h"
#include "planet/streaming/resident_tiles.h"
#include "planet/streaming/store_tiles.h"
#include "render/app/picture/earth_store.h"
#include "render/app/picture/imagery.h"
#include "render/app/picture/render_options.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/passes/sky.h"
#include "render/passes/terrain.h"
#include "render/picture/relief_patches.h"

namespace {

using namespace render;
using planet::SegmentView;
using planet::wgs84;

constexpr int width = 1920, height = 1080;
constexpr PicturePart part{0, 0, width, height};

/// What both ways of drawing share.
class World {
  public:
    World()
        : context_(Context::create({})),
          earth_(options_.earth),
          index_(user_checksum_index()),
          store_(open_earth_store(options_.earth, earth_, index_, options_.progress)),
          field(store_),
          tiles(field.cache(), {wgs84, 1}),
          target(width, height) {
        const Imagery imagery = open_imagery(
            {}, options_.earth, index_, [&] { return earth_.get().heights; }, threads, options_.progress);
        cubes_[0] = upload_cube(imagery.day, GL_SRGB8_ALPHA8);
        cubes_[1] = upload_cube(imagery.night, GL_SRGB8_ALPHA8);
        cubes_[2] = upload_cube(imagery.relief, GL_RGBA8_SNORM);
        texel_m = static_cast<float>(imagery.texel_m(wgs84.mean_radius()));
        set_reversed_depth();
    }

    void bind(SkyPass& sky, const Camera& camera, const Texture& patches) {
        sky.bind(camera, part);
        for (GLuint i = 0; i < 3; ++i) cubes_[i].bind(4 + i);
        patches.bind(7);
        target.bind();
    }

  private:
    RenderOptions options_;
    Context context_;
    LazyEarth earth_;
    ChecksumIndex index_;
    std::shared_ptr<const planet::ElevationStore> store_;
    Texture cubes_[3];

  public:
    const int finest_level = store_->metadata().finest_level;
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    float texel_m = 0;
    planet::StoreField field;
    planet::StoreTiles tiles;
    Framebuffer target;
};

World& world() {
    static World w;
    return w;
}

/// The strips of all segments as one list of triangles, with the patch layer as an attribute of the vertex.
class StaticList {
  public:
    StaticList(const planet::Segments& segments, std::span<const std::int32_t> segment_layers, bool from_afar) {
        ProgramOptions options;  // as TerrainPass chooses them
        if (from_afar) options.defines.push_back("FROM_AFAR");
        if (std::ranges::any_of(segment_layers, [](std::int32_t layer) { return layer >= 0; }))
            options.defines.push_back("PATCHED");
        program_ = Program::link({"terrain.vert.glsl", "terrain.frag.glsl"}, options);
        std::vector<std::uint32_t> list;
        std::vector<std::int32_t> layers(segments.vertices().size());
        for (std::size_t k = 0; k < segments.segments().size(); ++k) {
            const planet::Segment& s = segments.segments()[k];
            const std::uint32_t* strip = segments.indices().data() + s.first_index;
            for (std::uint32_t i = 0; i < s.index_count; ++i) layers[s.first_vertex + strip[i]] = segment_layers[k];
            for (std::uint32_t i = 0; i + 2 < s.index_count; ++i) {
                const std::uint32_t a = strip[i + (i & 1)], b = strip[i + 1 - (i & 1)], c = strip[i + 2];
                if (a != b && b != c && a != c)
                    for (const std::uint32_t v : {a, b, c}) list.push_back(s.first_vertex + v);
            }
        }
        count_ = static_cast<GLsizei>(list.size());
        indices_ = Buffer(bytes_of(list));
        vertices_ = Buffer(bytes_of(segments.vertices()));
        layers_ = Buffer(bytes_of(layers));
        array_ = VertexArray::create();
        array_.set_vertices(0, vertices_, sizeof(planet::SegmentVertex), segment_attributes());
        array_.set_vertices(1, layers_, sizeof(std::int32_t), std::array{layer_attribute()});
        array_.set_indices(indices_);
    }

    void draw(const Camera& camera, const TerrainLook& look) {
        program_.use();
        set_terrain_uniforms(program_, camera, part, look);
        array_.bind();
        gl().Enable(GL_DEPTH_TEST);
        gl().Enable(GL_CULL_FACE);
        gl().DepthFunc(GL_GREATER);
        gl().DrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
        gl().Disable(GL_CULL_FACE);
    }

    std::size_t triangles() const { return static_cast<std::size_t>(count_) / 3; }

  private:
    Program program_;
    VertexArray array_;
    Buffer vertices_, indices_, layers_;
    GLsizei count_ = 0;
};

struct View {
    double latitude, longitude, range, heading, pitch;  // degrees, metres
};
// The program's default globe, and the Sangre de Cristo from 60 km.
constexpr View globe{12, 12, 13.6e6, 0, -90}, blanca{37.58, -105.49, 60e3, 30, -25};

/// A view of the world, ready to be drawn both ways.
class Scene {
  public:
    explicit Scene(const View& v) {
        const glm::dvec3 n = planet::normal_from_geodetic(v.latitude * planet::degrees, v.longitude * planet::degrees);
        const double heading = v.heading * planet::degrees, pitch = v.pitch * planet::degrees;
        const double ground = static_cast<double>(w.field.height(n));
        camera = make_camera(planet::ecef_from_normal(wgs84, n, {ground}) - v.range * look_direction(n, heading, pitch),
                             n, heading, pitch, focal_length_px(40 * planet::degrees, width, height), width, height);
        planet::SegmentView view;
        view.test = {camera.eye, planet::split_reach(camera.focal_px, camera.tan_corner(), 0.5)};
        view.culling = camera.culling(part, wgs84.b - 600);
        view.radius_m = wgs84.mean_radius();
        view.finest_patch_level = w.finest_level - 10;
        view.segment_angle = 96 / camera.focal_px;
        segments.build(w.tiles, view, static_cast<int>(w.threads));
        patches.build(segments, surface(w.field), wgs84.mean_radius(), static_cast<int>(w.threads));
        patch_texture = patches.upload();
        const AtmosphereTables tables = make_tables();
        const RenderOptions defaults;
        ViewTable air = make_view_table(tables, camera.eye, planet::sun_direction(defaults.time), w.threads);
        air.uniforms.sky_detail.w = w.texel_m;
        sky.set_view(tables, air, glm::mat3(1));
        look.polar_stretch = (wgs84.a / wgs84.b) * (wgs84.a / wgs84.b);
        look.patch_range = patch_range;
        look.from_afar = !needs_close_up(air.uniforms, v.range, 1 / camera.focal_px);
        w.bind(sky, camera, patch_texture);
    }

    World& w = world();  // first: the rest needs its context
    Camera camera;
    planet::Segments segments;
    ReliefPatches patches;
    TerrainLook look;
    Texture patch_texture;
    SkyPass sky{{}, make_noise_levels()};

  private:
    static PatchSurface surface(const planet::StoreField& field) {
        return {.heights = [&field](auto normals, auto heights) { field.heights(normals, heights); },
                .spacing =
                    [&field](const glm::dvec3& normal) {
                        planet::SurfaceCursor cursor = field.cursor();
                        cursor.seek(normal);
                        return planet::cell_metrics(cursor.cell().bisection_level()).vertex_spacing *
                               wgs84.mean_radius();
                    }};
    }
};

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

void terrain_pass_over_static_list(benchmark::State& state, const View& view) {
    Scene scene(view);
    World& w = scene.w;
    TerrainPass pass;
    pass.upload(scene.segments, scene.patches.layers());
    StaticList list(scene.segments, scene.patches.layers(), scene.look.from_afar);
    const auto seconds = [&](auto&& draw) {
        w.target.clear(0, 0, 0, 1);
        gl().Finish();
        const auto start = std::chrono::steady_clock::now();
        draw();
        gl().Finish();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const auto draw_pass = [&] { pass.draw(scene.camera, part, scene.look); };
    const auto draw_list = [&] { list.draw(scene.camera, scene.look); };
    // Also the first time, which compiles. Both must show the same ground.
    seconds(draw_pass);
    const auto depth = w.target.read_depth();
    seconds(draw_list);
    if (w.target.read_depth() != depth) return state.SkipWithError("the list shows another surface");

    std::vector<double> pass_seconds, list_seconds;
    for (auto _ : state) {
        pass_seconds.push_back(seconds(draw_pass));
        list_seconds.push_back(seconds(draw_list));
        state.SetIterationTime(pass_seconds.back());
    }
    state.counters["triangles"] = static_cast<double>(list.triangles());
    state.counters["segments"] = static_cast<double>(scene.segments.segments().size());
    state.counters["pass_ms"] = 1e3 * median(pass_seconds);
    state.counters["list_ms"] = 1e3 * median(list_seconds);
    state.counters["ratio"] = median(pass_seconds) / median(list_seconds);
}
BENCHMARK_CAPTURE(terrain_pass_over_static_list, globe, globe)
    ->Iterations(25)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(terrain_pass_over_static_list, blanca, blanca)
    ->Iterations(15)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// Down to the Sangre de Cristo, at half a pixel, tiles loaded by other threads ahead of the eye as in the viewer: every
/// frame updates, uploads and draws the terrain's shading, without patches of normals, sky and stars. Then at rest.
class Flight {
  public:
    /// What is known of the next frame while one is drawn: nothing; that the motion goes on; its view, as where a path is
    /// flown.
    enum class Expected { nothing, guessed, known };
    static constexpr int frames = 600, frames_ahead = 10;
    static constexpr std::size_t tiles_a_frame = 400;  // as the viewer, which draws five frames a second here

    struct Times {
        std::vector<double> update, upload, draw;  // seconds
        std::vector<double> ahead;                 // seconds of another thread, while a frame is drawn
        std::vector<double> sent;                  // bytes
        std::vector<double> pending;               // tiles that the view needs and that have not come
    };

    explicit Flight(Expected expected) : expected_(expected) {}

    Times fly() {
        Times t;
        SegmentView before;
        for (int frame = 0; frame < frames; ++frame) {
            const Camera now = camera(frame);
            const SegmentView view = view_of(now);
            step(view, view_ahead(frame), t);
            if (expected_ == Expected::known && frame + 1 < frames)
                mesh_ahead_.begin(view_of(camera(frame + 1)), view_ahead(frame + 1), tiles_a_frame, 1);
            if (expected_ == Expected::guessed && frame > 0)
                mesh_ahead_.begin(planet::view_after(before, view), view_ahead(frame + 1), tiles_a_frame, 1);
            t.draw.push_back(draw(now));
            before = view;
        }
        mesh_ahead_.finish();
        return t;
    }
    /// Once more, where the flight ends and every tile has come.
    Times rest() {
        const Camera last = camera(frames - 1);
        segments_.invalidate(tiles_.settle(view_of(last)));
        Times t;
        for (int frame = 0; frame < 50; ++frame) step(view_of(last), view_of(last), t);
        return t;
    }
    std::size_t triangles() const { return segments_.leaf_count(); }

  private:
    /// From 20,000 km above the ground to 50 m, by the same factor each frame.
    Camera camera(int frame) const {
        const double gone = static_cast<double>(frame) / (frames - 1);
        const double up = std::exp(std::lerp(std::log(20e6), std::log(50.0), gone)), aside = 30 * std::sqrt(up / 20e6);
        const glm::dvec3 n =
            planet::normal_from_geodetic((37.58 - aside) * planet::degrees, (-105.49 - aside) * planet::degrees);
        const double ground = static_cast<double>(w_.field.height(n));
        return make_camera(planet::ecef_from_normal(wgs84, n, {ground + up}), n,
                           std::lerp(-60.0, 80.0, gone) * planet::degrees,
                           std::lerp(-90.0, -4.0, gone) * planet::degrees,
                           focal_length_px(40 * planet::degrees, width, height), width, height);
    }

    SegmentView view_of(const Camera& camera) const {
        SegmentView view;
        view.test = {camera.eye, planet::split_reach(camera.focal_px, camera.tan_corner(), 0.5)};
        view.culling = camera.culling(part, wgs84.b - 600);
        view.radius_m = wgs84.mean_radius();
        view.finest_patch_level = w_.finest_level - 10;
        view.segment_angle = 96 / camera.focal_px;
        return view;
    }

    SegmentView view_ahead(int frame) const { return view_of(camera(std::min(frame + frames_ahead, frames - 1))); }

    void step(const SegmentView& view, const SegmentView& ahead, Times& t) {
        t.update.push_back(seconds([&] {
            const bool prepared = mesh_ahead_.finish();
            segments_.invalidate(tiles_.update(view, &ahead, prepared ? 0 : tiles_a_frame));
            segments_.update(tiles_, view, static_cast<int>(w_.threads));
        }));
        t.ahead.push_back(mesh_ahead_.seconds());
        t.pending.push_back(static_cast<double>(tiles_.residency().pending));
        layers_.assign(segments_.segments().size(), -1);
        t.upload.push_back(seconds([&] { pass_.upload(segments_, layers_); }));
        t.sent.push_back(static_cast<double>(pass_.sent_bytes()));
    }

    double draw(const Camera& camera) {
        ViewTable air = make_view_table(tables_, camera.eye, planet::sun_direction(RenderOptions{}.time), w_.threads);
        air.uniforms.sky_detail.w = w_.texel_m;
        sky_.set_view(tables_, air, glm::mat3(1));
        TerrainLook look;
        look.polar_stretch = (wgs84.a / wgs84.b) * (wgs84.a / wgs84.b);
        const double up = planet::height_from_ecef(wgs84, camera.eye).m;
        look.from_afar = !needs_close_up(air.uniforms, std::max(up - 9000, 0.0), 1 / camera.focal_px);
        w_.bind(sky_, camera, no_patches_);
        w_.target.clear(0, 0, 0, 1);
        gl().Finish();
        return seconds([&] {
            pass_.draw(camera, part, look);
            gl().Finish();
        });
    }

    static Texture no_patches() {
        ReliefPatches none;
        none.build({}, {}, wgs84.mean_radius(), 1);
        return none.upload();
    }

    template <class Work>
    static double seconds(Work&& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    World& w_ = world();  // first: the rest needs its context
    planet::ResidentTiles tiles_{w_.field.cache(), {wgs84, 1}, std::max(1u, w_.threads / 2)};
    planet::Segments segments_;
    planet::MeshAhead mesh_ahead_{tiles_, segments_};
    Expected expected_;
    std::vector<std::int32_t> layers_;
    TerrainPass pass_;
    AtmosphereTables tables_ = make_tables();
    SkyPass sky_{{}, make_noise_levels()};
    Texture no_patches_ = no_patches();
};

double mean(const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}
double percentile(std::vector<double> v, double share) {
    const auto at = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
    std::nth_element(v.begin(), at, v.end());
    return *at;
}

void flight(benchmark::State& state, Flight::Expected expected) {
    Flight flight(expected);
    for (auto _ : state) {
        const Flight::Times moving = flight.fly(), rest = flight.rest();
        const double frame = mean(moving.update) + mean(moving.upload) + mean(moving.draw);
        state.SetIterationTime(frame);
        state.counters["update_share"] = mean(moving.update) / frame;
        state.counters["ahead_share"] = mean(moving.ahead) / frame;
        state.counters["ahead_ms"] = 1e3 * median(moving.ahead);
        state.counters["upload_share"] = mean(moving.upload) / frame;
        state.counters["update_ms"] = 1e3 * median(moving.update);
        state.counters["update_p99_ms"] = 1e3 * percentile(moving.update, 0.99);
        state.counters["update_most_ms"] = 1e3 * percentile(moving.update, 1);
        state.counters["pending"] = mean(moving.pending);
        state.counters["pending_p99"] = percentile(moving.pending, 0.99);
        state.counters["draw_ms"] = 1e3 * median(moving.draw);
        state.counters["sent_kB"] = 1e-3 * median(moving.sent);
        state.counters["sent_p99_kB"] = 1e-3 * percentile(moving.sent, 0.99);
        state.counters["rest_update_us"] = 1e6 * median(rest.update);
        state.counters["rest_sent_B"] = median(rest.sent);
        state.counters["triangles"] = static_cast<double>(flight.triangles());
    }
}
BENCHMARK_CAPTURE(flight, nothing, Flight::Expected::nothing)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(flight, guessed, Flight::Expected::guessed)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(flight, known, Flight::Expected::known)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
