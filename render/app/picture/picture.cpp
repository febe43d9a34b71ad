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
#include "render/app/picture/globe_looks.h"
#include "render/app/picture/imagery.h"
#include "render/app/picture/layer_data.h"
#include "render/app/picture/part_mesh.h"
#include "render/app/picture/steps.h"
#include "render/gl/framebuffer.h"

namespace render {

namespace {

using planet::wgs84;

/// Nothing larger is drawn at once. Parts of larger pictures have a margin that is not kept: a star whose middle is
/// outside is not drawn, but its light would reach inside.
constexpr int largest_drawn = 2048, part_margin = 8, least_part = 64;
/// Two bands, one part high, are in memory: 120 MB each if they have so many pixels. Flatter parts than half cost time.
constexpr int band_pixels = 40'000'000, least_part_height = (largest_drawn - 2 * part_margin) / 2;

PicturePart grown(const PicturePart& part, int margin) {
    return {part.x - margin, part.y - margin, part.width + 2 * margin, part.height + 2 * margin};
}

/// What two have in common; no width or no height where there is nothing.
PicturePart common(const PicturePart& a, const PicturePart& b) {
    const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
    return {x, y, std::max(std::min(a.x + a.width, b.x + b.width) - x, 0),
            std::max(std::min(a.y + a.height, b.y + b.height) - y, 0)};
}

/// The parts of a picture, in rows from the top, and in smaller pieces where one is too much at once. They are the same
/// whatever of the picture is wanted, which is why a crop has the pixels of the whole.
class Parts {
  public:
    Parts(const Camera& camera, const PictureCrop& wanted)
        : wanted_{wanted.x, wanted.y, wanted.width, wanted.height},
          single_(camera.width <= largest_drawn && camera.height <= largest_drawn),
          width_(single_ ? largest_drawn : largest_drawn - 2 * part_margin),
          height_(std::clamp(band_pixels / camera.width, std::min(least_part_height, width_), width_)) {
        for (int y = 0; y < camera.height; y += height_)
            for (int x = 0; x < camera.width; x += width_)
                add({x, y, std::min(width_, camera.width - x), std::min(height_, camera.height - y)});
        std::ranges::reverse(rest_);
    }

    /// Ever the next one is the last.
    bool empty() const { return rest_.empty(); }
    PicturePart take() {
        const PicturePart part = rest_.back();
        rest_.pop_back();
        return part;
    }
    bool can_be_split(const PicturePart& part) const {
        return !single_ && std::min(part.width, part.height) >= 2 * least_part;
    }
    /// Its quarters come next.
    void put_back_split(const PicturePart& part) {
        const int w = part.width / 2, h = part.height / 2;
        add({part.x + w, part.y + h, part.width - w, part.height - h});
        add({part.x, part.y + h, w, part.height - h});
        add({part.x + w, part.y, part.width - w, h});
        add({part.x, part.y, w, h});
    }

    PicturePart drawn(const PicturePart& part) const { return single_ ? part : grown(part, part_margin); }
    PicturePart kept(const PicturePart& part) const { return common(part, wanted_); }
    /// The rows of what is wanted that come with a part.
    PicturePart band(const PicturePart& part) const {
        return common({wanted_.x, part.y / height_ * height_, wanted_.width, height_}, wanted_);
    }

  private:
    void add(const PicturePart& part) {
        const PicturePart k = kept(part);
        if (k.width > 0 && k.height > 0) rest_.push_back(part);
    }

    PicturePart wanted_;
    bool single_;
    int width_, height_;  ///< of parts
    std::vector<PicturePart> rest_;
};

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
          mesher_(options, surface_, camera_, steps),
          parts_(camera_, options.drawn()) {
        begin_mesh();
        open_looks();
    }

    void paint(BandWriter& output) {
        std::vector<std::uint8_t> pixels;
        PicturePart band;  // of these pixels
        double done = 0;
        const double all = static_cast<double>(options_.drawn().width) * options_.drawn().height;
        const auto write_band = [&] {
            if (band.height > 0) output.write(std::exchange(pixels, {}), band.height);
        };
        while (const auto part = next_mesh()) {
            if (const PicturePart next = parts_.band(*part); next.y != band.y || band.height == 0) {
                write_band();
                band = next;
                pixels.resize(static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.height) * 3);
            }
            const PicturePart kept = parts_.kept(*part);
            paint_part(parts_.drawn(*part), kept, meshes_[last_].segments, band, pixels);
            done += static_cast<double>(kept.width) * kept.height;
            options_.progress("drawing", done / all);
        }
        write_band();
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

    /// Starts making the mesh of the next part. Two are in use at a time: that one, and the one that is drawn.
    void begin_mesh() {
        made_ = 1 - made_;
        mesh_ = beside(threads_, [this]() -> std::optional<PicturePart> {
            while (!parts_.empty()) {
                const PicturePart part = parts_.take();
                const auto crowd = parts_.can_be_split(part) ? PartMesher::Crowd::refused : PartMesher::Crowd::coarser;
                if (mesher_.build(parts_.drawn(part), crowd, meshes_[made_])) return part;
                parts_.put_back_split(part);
            }
            return {};
        });
    }

    /// Uploads a mesh and begins another. @return the part it is of; nothing behind the last one
    std::optional<PicturePart> next_mesh() {
        const std::optional<PicturePart> part = mesh_.get();
        if (!part) return part;
        const PartMesh& mesh = meshes_[made_];
        const planet::Segments& segments = mesh.segments;
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
        last_ = made_;
        begin_mesh();
        return part;
    }

    /// @param part that is drawn @param kept of it @param band of the picture, into whose pixels that goes
    void paint_part(const PicturePart& part, const PicturePart& kept, const planet::Segments& segments,
                    const PicturePart& band, std::vector<std::uint8_t>& pixels) {
        std::vector<std::uint8_t> drawn;
        steps_.time("draw", [&] {
            if (!target_ || target_.width() != part.width || target_.height() != part.height) {
                target_ = Framebuffer();  // before another takes memory
                const int samples = looks_.samples(options_, camera_, context_.limits().samples);
                target_ = Framebuffer(part.width, part.height, looks_.target_options(samples));
            }
            target_.bind();
            // What is not wanted need not be drawn, but for where the depth of what layers lie on is looked up. OpenGL
            // counts rows from below.
            const PicturePart needed = layers_.empty() ? kept : grown(kept, LayerPass::reach_px);
            gl().Enable(GL_SCISSOR_TEST);
            gl().Scissor(needed.x - part.x, part.y + part.height - needed.y - needed.height, needed.width,
                         needed.height);
            target_.clear(0, 0, 0, 1);
            DrapeGround ground = surface_.for_layers(segments, camera_, part, options_.drawn_scale());
            looks_.draw({.camera = camera_,
                         .part = part,
                         .exaggeration = options_.exaggeration,
                         .patches = patch_texture_,
                         .ground = ground,
                         .relief = options_.shows(Overlay::relief),
                         .pixel_scale = options_.drawn_scale()},
                        target_);
            drawn = target_.read_rgba8();
            gl().Disable(GL_SCISSOR_TEST);
        });
        const auto index = [](const PicturePart& of, int x, int y) {
            return static_cast<std::size_t>(y - of.y) * static_cast<std::size_t>(of.width) +
                   static_cast<std::size_t>(x - of.x);
        };
        for (int y = kept.y; y < kept.y + kept.height; ++y) {
            const std::uint8_t* from = drawn.data() + index(part, kept.x, y) * 4;
            std::uint8_t* to = pixels.data() + index(band, kept.x, y) * 3;
            for (int x = 0; x < kept.width; ++x, from += 4, to += 3) std::copy_n(from, 3, to);
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
        const planet::SplitTest& test = meshes_[last_].view.test;  // the same for all parts
        const auto picked = planet::pick(mesher_.tiles(), test, camera_.eye, forward);
        if (!picked) return;
        const glm::dvec3 normal = planet::normal_from_ecef(wgs84, picked->position);
        planet::SurfaceCursor cursor = surface_.field.cursor();
        report_.centre = {planet::geodetic_from_normal(normal), planet::ground_at(cursor, normal), picked->distance,
                          picked->deviation};
    }

    /// What a frame costs once the last part is drawn: the same view again, and the eye a hundredth of its height ahead.
    void measure_frames() {
        PartMesh& mesh = meshes_[last_];
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
    Parts parts_;
    PartMesh meshes_[2];
    int made_ = 0, last_ = 0;                         ///< of these: the one being made, and the last that was drawn
    std::future<std::optional<PicturePart>> mesh_{};  ///< last: its end waits for work that uses all of the above
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
