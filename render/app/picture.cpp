#include "render/app/picture.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/sun.h"
#include "planet/mesh/pick.h"
#include "render/app/band_writer.h"
#include "render/app/data_path.h"
#include "render/app/drawn_surface.h"
#include "render/app/earth_store.h"
#include "render/app/globe_looks.h"
#include "render/app/imagery.h"
#include "render/app/layer_data.h"
#include "render/app/part_mesh.h"
#include "render/app/steps.h"
#include "render/gl/framebuffer.h"

namespace render {

namespace {

using planet::wgs84;

constexpr int part_side = 2048;

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
          mesher_(options, surface_, camera_, steps) {
        for (int y = 0; y < camera_.height; y += part_side)
            for (int x = 0; x < camera_.width; x += part_side)
                parts_.push_back(
                    {x, y, std::min(part_side, camera_.width - x), std::min(part_side, camera_.height - y)});
        begin_mesh(0);
        open_looks();
    }

    void paint(BandWriter& output) {
        std::vector<std::uint8_t> band;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const PicturePart& part = parts_[i];
            if (part.x == 0) band.resize(static_cast<std::size_t>(camera_.width * part.height) * 3);
            upload_mesh(i);
            paint_part(part, meshes_[i & 1].segments, band);
            options_.progress("drawing", static_cast<double>(i + 1) / static_cast<double>(parts_.size()));
            if (part.x + part.width == camera_.width) output.write(std::exchange(band, {}), part.height);
        }
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

    /// Starts making the mesh of a part. Two are in use at a time: that one, and the one that is drawn.
    void begin_mesh(std::size_t i) {
        if (i < parts_.size()) mesh_ = beside(threads_, [this, i] { mesher_.build(parts_[i], meshes_[i & 1]); });
    }

    void upload_mesh(std::size_t i) {
        mesh_.get();
        const PartMesh& mesh = meshes_[i & 1];
        const planet::Segments& segments = mesh.segments;
        begin_mesh(i + 1);
        steps_.time("upload", [&] {
            looks_.terrain().upload(segments, mesh.patches.layers());
            looks_.overlay().upload(segments, mesher_.tiles());
            patch_texture_ = mesh.patches.upload();
        });
        report_.triangles += segments.leaf_count();
        report_.vertices += segments.vertex_count();
        report_.strip_indices += segments.index_count();
        report_.sent_bytes += looks_.terrain().sent_bytes();
        report_.deviation_max_m = std::max(report_.deviation_max_m, mesh.deviation_max_m);
        report_.pixel_deviation_max = std::max(report_.pixel_deviation_max, mesh.pixel_deviation_max);
    }

    void paint_part(const PicturePart& part, const planet::Segments& segments, std::vector<std::uint8_t>& band) {
        std::vector<std::uint8_t> pixels;
        steps_.time("draw", [&] {
            const int samples = options_.samples > 0 ? options_.samples
                                : looks_.from_afar(camera_, options_.exaggeration)
                                    ? 1
                                    : std::min(4, context_.limits().samples);
            if (!target_ || target_.width() != part.width || target_.height() != part.height)
                target_ = Framebuffer(part.width, part.height, looks_.target_options(samples));
            target_.bind();
            target_.clear(0, 0, 0, 1);
            DrapeGround ground = surface_.for_layers(segments, camera_, part);
            looks_.draw({.camera = camera_,
                         .part = part,
                         .exaggeration = options_.exaggeration,
                         .patches = patch_texture_,
                         .ground = ground,
                         .relief = options_.shows(Overlay::relief)},
                        target_);
            pixels = target_.read_rgba8();
        });
        for (int y = 0; y < part.height; ++y) {
            const std::uint8_t* from =
                pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(part.width) * 4;
            std::uint8_t* to = band.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                                              static_cast<std::size_t>(part.x)) *
                                                 3;
            for (int x = 0; x < part.width; ++x, from += 4, to += 3) std::copy_n(from, 3, to);
        }
    }

    void fill_report() {
        report_.tiles = mesher_.counts();
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
        const planet::SplitTest& test = meshes_[(parts_.size() - 1) & 1].view.test;  // the same for all parts
        const auto picked = planet::pick(mesher_.tiles(), test, camera_.eye, forward);
        if (!picked) return;
        const glm::dvec3 normal = planet::normal_from_ecef(wgs84, picked->position);
        planet::SurfaceCursor cursor = surface_.field.cursor();
        report_.centre = {planet::geodetic_from_normal(normal), planet::ground_at(cursor, normal), picked->distance,
                          picked->deviation};
    }

    /// What a frame costs once the last part is drawn: the same view again, and the eye a hundredth of its height ahead.
    void measure_frames() {
        PartMesh& mesh = meshes_[(parts_.size() - 1) & 1];
        const glm::dvec3 forward = -glm::dvec3(glm::transpose(camera_.view_from_ecef)[2]);
        const glm::dvec3 ahead = camera_.eye + forward * (0.01 * std::abs(report_.eye_height_m));
        const auto frame = [&](const glm::dvec3& eye) {
            mesh.view.test.eye = mesh.view.culling.eye = eye;
            const double start = thread_seconds();
            mesh.segments.update(mesher_.tiles(), mesh.view);
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
    PartMesher mesher_;
    GlobeLooks looks_;
    Texture patch_texture_;
    Framebuffer target_;
    std::vector<PicturePart> parts_;
    PartMesh meshes_[2];      ///< by the last bit of the part's number
    std::future<void> mesh_;  ///< last: its end waits for work that uses all of the above
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
