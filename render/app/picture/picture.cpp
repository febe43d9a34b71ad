#include "render/app/picture/picture.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <optional>
#include <utility>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/sun.h"
#include "planet/mesh/pick.h"
#include "render/app/data_path.h"
#include "render/app/picture/band_writer.h"
#include "render/app/picture/drawn_surface.h"
#include "render/app/picture/earth_store.h"
#include "render/app/picture/imagery.h"
#include "render/app/picture/layer_data.h"
#include "render/app/picture/part_painter.h"
#include "render/app/picture/steps.h"

namespace render {

namespace {

using planet::wgs84;

/// Processor time of this thread.
double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// All that is the same for every part of the picture. Beside the thread of OpenGL, which opens the context, compiles
/// shaders and uploads, run: the tables that do not depend on the view from the start; the air of the view and the first
/// part's mesh as soon as there are a store and a camera; then each part's mesh while the part before is drawn.
class Painter {
  public:
    Painter(const RenderOptions& options, PictureReport& report, Steps& steps)
        : options_(options),
          report_(report),
          steps_(steps),
          threads_(options.thread_count()),
          noise_(beside(threads_, [this] { return steps_.time("noise", [] { return make_noise_levels(); }); })),
          tables_(beside(threads_, [this] { return steps_.time("air", [] { return make_tables(); }); })),
          layers_read_(beside(threads_, [this] { return steps_.time("layers", [&] { return load_layers(); }); })),
          context_(steps_.time("context", [&] { return Context::create({.backend = options.backend}); })),
          earth_(options.earth),
          index_(user_checksum_index()),
          surface_(steps_.time("store", [&] { return open_store(); }), options),
          camera_(steps_.time("store", [&] { return surface_.camera(options); })),
          parts_(options, surface_, camera_, steps) {
        open_looks();
    }

    void paint(BandWriter& output) {
        parts_.paint(looks_, context_.limits().samples,
                     {.write = [&](std::vector<std::uint8_t> band, int rows) { output.write(std::move(band), rows); },
                      .progress = [this](double part) { options_.progress("drawing", part); }});
        index_.save();
        fill_report();
        if (options_.measure_frames) measure_frames();
    }

  private:
    std::shared_ptr<const planet::ElevationStore> open_store() {
        if (options_.store)
            return std::make_shared<const planet::ElevationStore>(planet::ElevationStore::open(*options_.store, wgs84));
        return open_earth_store(options_.earth, earth_, index_, options_.progress);
    }

    LayerData load_layers() {
        if (!options_.layers.empty()) options_.progress("reading layers", std::numeric_limits<double>::quiet_NaN());
        return LayerData::load(options_);
    }

    void open_looks() {
        auto air = beside(threads_, [this] {
            const AtmosphereTables tables = tables_.get();
            return steps_.time("air", [&] {
                return std::pair(tables,
                                 make_view_table(tables, camera_.eye, planet::sun_direction(options_.time), threads_));
            });
        });
        const Imagery imagery = steps_.time("imagery", [&] {
            return open_imagery(
                options_.imagery, options_.earth, index_, [&] { return earth_.get().heights; }, threads_,
                options_.progress);
        });
        steps_.time("textures", [&] { looks_.upload(imagery); });
        const std::vector<Star> stars = steps_.time("stars", [] { return read_stars(data_file("stars.csv")); });
        const auto noise = noise_.get();
        steps_.time("shaders", [&] { looks_.link(stars, noise, overlays_of(options_)); });
        const auto [tables, view] = air.get();
        looks_.set_sky(tables, view, options_.time);
        layers_ = layers_read_.get();
        looks_.set_layers(layers_.shown(options_), layers_.needs_stencil());
        set_reversed_depth();
    }

    void fill_report() {
        const PaintedParts& painted = parts_.painted();
        report_.triangles = painted.triangles;
        report_.vertices = painted.vertices;
        report_.strip_indices = painted.strip_indices;
        report_.sent_bytes = painted.sent_bytes;
        report_.deviation_max_m = painted.deviation_max_m;
        report_.pixel_deviation_max = painted.pixel_deviation_max;
        report_.tiles = parts_.counts();
        report_.layers = layers_.report();
        report_.damage = surface_.field.cache().damage();
        report_.eye_height_m = planet::height_from_ecef(wgs84, camera_.eye).m;
        report_.crs = "EPSG:4978";
        report_.vertical_datum = planet::name_of(surface_.store->metadata().datum);
        report_.sources = surface_.store->metadata().sources;
        report_.backend = backend_name(context_.backend());
        report_.gl_version = context_.gl_version();
        report_.gl_renderer = context_.gl_renderer();
        pick_centre();
    }

    void pick_centre() {
        const glm::dvec3 forward = -glm::dvec3(glm::transpose(camera_.view_from_ecef)[2]);
        const planet::SplitTest& test = parts_.last_mesh().view.test;  // the same for all parts
        const auto picked = planet::pick(parts_.tiles(), test, camera_.eye, forward);
        if (!picked) return;
        const glm::dvec3 normal = planet::normal_from_ecef(wgs84, picked->position);
        planet::SurfaceCursor cursor = surface_.field.cursor();
        report_.centre = {planet::geodetic_from_normal(normal), planet::ground_at(cursor, normal), picked->distance,
                          picked->deviation};
    }

    /// What a frame costs once the last part is drawn: the same view again, and the eye a hundredth of its height ahead.
    void measure_frames() {
        PartMesh& mesh = parts_.last_mesh();
        const glm::dvec3 forward = -glm::dvec3(glm::transpose(camera_.view_from_ecef)[2]);
        const glm::dvec3 ahead = camera_.eye + forward * (0.01 * std::abs(report_.eye_height_m));
        const auto frame = [&](const glm::dvec3& eye) {
            mesh.view.test.eye = mesh.view.culling.eye = eye;
            const double start = thread_seconds();
            mesh.segments.update(parts_.tiles(), mesh.view);
            const double seconds = thread_seconds() - start;
            looks_.terrain().upload(mesh.segments, std::vector<std::int32_t>(mesh.segments.segments().size(), -1));
            return FrameCost{seconds, looks_.terrain().sent_bytes()};
        };
        for (const glm::dvec3& eye : {ahead, camera_.eye}) frame(eye);  // tiles are loaded now
        report_.at_rest = frame(camera_.eye);
        report_.moving = frame(ahead);
    }

    const RenderOptions& options_;
    PictureReport& report_;
    Steps& steps_;
    unsigned threads_;
    std::future<std::vector<std::vector<std::uint8_t>>> noise_;
    std::future<AtmosphereTables> tables_;
    std::future<LayerData> layers_read_;
    LayerData layers_;
    Context context_;
    LazyEarth earth_;
    ChecksumIndex index_;
    DrawnSurface surface_;
    Camera camera_;
    GlobeLooks looks_;
    PartPainter parts_;  // last: its end waits for work that uses all of the above
};

}  // namespace

PictureReport draw_picture(const RenderOptions& options) {
    PictureReport report;
    Steps steps;
    BandWriter output(options, steps);
    Painter(options, report, steps).paint(output);  // its end, closing OpenGL, runs beside the encoding
    output.finish();
    report.seconds = steps.list();
    return report;
}

}  // namespace render
