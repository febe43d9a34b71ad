#include "render/app/fly/film.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/sun.h"
#include "render/app/picture/part_painter.h"
#include "render/app/picture/steps.h"
#include "render/app/view/globe_data.h"
#include "render/app/view/live_mesh.h"
#include "render/viewer/flight_clearance.h"

namespace render {

namespace {

using planet::wgs84;

GlobeData load(const RenderOptions& options) {
    GlobeLoading loading(options);
    while (!loading.wait(std::chrono::milliseconds(50))) {
        const GlobeLoading::Progress progress = loading.progress();
        options.progress(progress.step, progress.part);
    }
    return loading.take();
}

/// The mesh follows from frame to frame; while a frame is drawn, the air of the next one is made and the one before is
/// written.
class Film {
  public:
    Film(const FilmOptions& options, const FlightPlan& plan, FrameOutput& output)
        : options_(options),
          render_(options.render),
          output_(output),
          threads_(render_.thread_count()),
          in_parts_(std::max(render_.size.width, render_.size.height) > render_.part_side),
          tables_(beside(threads_, [] { return make_tables(); })),
          context_(Context::create({.backend = render_.backend})),
          data_(steps_.time("load", [&] { return load(render_); })),
          path_(flight_path(plan, *data_.surface)),
          clearance_(steps_.time("path",
                                 [&] {
                                     return FlightClearance(path_,
                                                            [this](const glm::dvec3& normal, double exaggeration) {
                                                                return data_.surface->ground(normal, exaggeration);
                                                            });
                                 })),
          mesh_(render_, *data_.surface,
                std::min<std::size_t>(2048, static_cast<std::size_t>(context_.limits().array_layers))) {
        choose_frames();
        steps_.time("textures", [&] { looks_.upload(data_.imagery); });
        data_.imagery = {};
        steps_.time("shaders", [&] { looks_.link(data_.stars, data_.noise, overlays_of(render_)); });
        looks_.set_layers(data_.layers.shown(render_), data_.layers.needs_stencil());
        report_.layers = data_.layers.report();
        set_reversed_depth();
    }

    FilmReport draw() {
        begin_air(next_to_draw(report_.first_frame));
        for (long i = next_to_draw(report_.first_frame); i <= report_.last_frame; i = next_to_draw(i + 1)) {
            ++report_.drawn_frames;
            draw_frame(i);
            render_.progress("frames", static_cast<double>(i + 1 - report_.first_frame) /
                                           static_cast<double>(report_.last_frame + 1 - report_.first_frame));
        }
        if (writing_.valid()) writing_.get();
        fill_report();
        return std::move(report_);
    }

  private:
    void choose_frames() {
        report_.flight_seconds = path_.duration();
        const double last = std::floor(path_.duration() * options_.fps + 1e-6);
        if (!(last < most_frames))
            throw planet::Error(planet::Fault::bad_usage, "--fps", "the flight has more frames than can be numbered",
                                "at most " + std::to_string(most_frames) + " frames");
        report_.frames_of_flight = static_cast<long>(last) + 1;
        report_.last_frame = report_.frames_of_flight - 1;
        if (!options_.frames) return;
        if (options_.frames->second > report_.last_frame)
            throw planet::Error(planet::Fault::bad_usage, "--frames",
                                std::to_string(options_.frames->second) + " is not in the flight",
                                "0 to " + std::to_string(report_.last_frame));
        std::tie(report_.first_frame, report_.last_frame) = *options_.frames;
    }

    /// That one or the next that is not there yet; the one behind the last where all are.
    long next_to_draw(long frame) const {
        while (frame <= report_.last_frame && output_.has(frame)) ++frame;
        return frame;
    }

    double seconds_of(long frame) const { return static_cast<double>(frame) / options_.fps; }

    /// Before the ground of just that moment is looked at.
    glm::dvec3 eye_at(double seconds, const FlightView& view) const {
        const glm::dvec3 eye = eye_of(view.sight, path_.about());
        const double lift = clearance_.lift(seconds);
        return lift > 0 ? eye + lift * planet::normal_from_ecef(wgs84, eye) : eye;
    }

    Camera camera_at(double seconds, const FlightView& view) const {
        const Sight& s = view.sight;
        const auto [width, height] = render_.size;
        glm::dvec3 eye = eye_at(seconds, view);
        // As a picture's: a range may end below the ground, a height does not.
        if (path_.about() == About::place)
            eye = data_.surface->above_ground(eye, view.exaggeration, std::min(least_clearance_m, s.range));
        return make_camera(eye, s.normal, s.heading, s.pitch, focal_length_px(render_.fov, width, height), width,
                           height);
    }

    void begin_air(long frame) {
        if (frame > report_.last_frame) return;
        const double seconds = seconds_of(frame);
        const FlightView view = path_.at(seconds);
        air_ = beside(threads_, [this, eye = camera_at(seconds, view).eye, time = view.time] {
            return steps_.time(
                "air", [&] { return make_view_table(tables_.get(), eye, planet::sun_direction(time), threads_); });
        });
    }

    void draw_frame(long frame) {
        const double seconds = seconds_of(frame);
        const FlightView view = path_.at(seconds);
        const Camera camera = camera_at(seconds, view);
        if (view.exaggeration != render_.exaggeration) {
            render_.exaggeration = data_.surface->exaggeration = view.exaggeration;
            mesh_.place_anew();
        }
        if (in_parts_) {
            begin_next(frame, view);
            write(frame, draw_in_parts(camera));
        } else {
            settle(seconds, camera);
            begin_next(frame, view);
            write(frame, draw_at_once(camera));
        }
    }

    /// What other threads do for the next frame while this one is drawn.
    void begin_next(long frame, const FlightView& view) {
        looks_.set_sky(tables_.get(), air_.get(), view.time);
        const long next = next_to_draw(frame + 1);
        begin_air(next);
        if (in_parts_ || next > report_.last_frame) return;
        const FlightView coming = path_.at(seconds_of(next));
        if (coming.exaggeration == view.exaggeration) mesh_.make_next(camera_at(seconds_of(next), coming));
    }

    void settle(double seconds, const Camera& camera) {
        constexpr double ahead_s = 0.5;
        const double later = std::min(seconds + ahead_s, path_.duration());
        const glm::dvec3 way = later > seconds ? eye_at(later, path_.at(later)) - camera.eye : glm::dvec3(0);
        steps_.time("mesh", [&] { mesh_.settle({.camera = camera, .velocity_m_s = way / ahead_s}); });
        steps_.time("upload", [&] {
            looks_.terrain().upload(mesh_.segments(), mesh_.patches().layers());
            looks_.overlay().upload(mesh_.segments(), mesh_.tiles());
        });
        report_.tiles = mesh_.counts();
        note_mesh(mesh_.segments().leaf_count(), mesh_.deviation_m(), mesh_.pixel_deviation());
    }

    void note_mesh(std::size_t triangles, double deviation_m, double pixel_deviation) {
        report_.triangles_max = std::max(report_.triangles_max, triangles);
        report_.deviation_max_m = std::max(report_.deviation_max_m, deviation_m);
        report_.pixel_deviation_max = std::max(report_.pixel_deviation_max, pixel_deviation);
    }

    /// @return RGB, as the other one
    std::vector<std::uint8_t> draw_at_once(const Camera& camera) {
        return steps_.time("draw", [&] {
            const int samples = looks_.samples(render_, camera, context_.limits().samples);
            if (!target_ || target_.samples() != samples)
                target_ = Framebuffer(camera.width, camera.height, looks_.target_options(samples));
            target_.bind();
            target_.clear(0, 0, 0, 1);
            const PicturePart whole{0, 0, camera.width, camera.height};
            DrapeGround ground = data_.surface->for_layers(mesh_.segments(), camera, whole, render_.drawn_scale());
            looks_.draw({.camera = camera,
                         .part = whole,
                         .exaggeration = render_.exaggeration,
                         .patches = mesh_.patches().texture(),
                         .ground = ground,
                         .morph_reach = mesh_.morph_reach(),
                         .relief = render_.shows(Overlay::relief),
                         .pixel_scale = render_.drawn_scale()},
                        target_);
            return rgb_of(target_.read_rgba8());
        });
    }

    std::vector<std::uint8_t> draw_in_parts(const Camera& camera) {
        std::vector<std::uint8_t> rgb;
        PartPainter parts(render_, *data_.surface, camera, steps_);
        parts.paint(looks_, context_.limits().samples, {.write = [&](const std::vector<std::uint8_t>& band, int) {
                        rgb.insert(rgb.end(), band.begin(), band.end());
                    }});
        const PaintedParts& painted = parts.painted();
        report_.tiles = parts.counts();
        note_mesh(painted.triangles, painted.deviation_max_m, painted.pixel_deviation_max);
        return rgb;
    }

    void write(long frame, std::vector<std::uint8_t> rgb) {
        if (writing_.valid()) writing_.get();
        writing_ = beside(threads_, [this, frame, pixels = std::move(rgb)] {
            steps_.time("write", [&] { output_.write(frame, pixels); });
        });
    }

    static std::vector<std::uint8_t> rgb_of(std::vector<std::uint8_t> rgba) {
        const std::size_t count = rgba.size() / 4;
        for (std::size_t i = 1; i < count; ++i) std::copy_n(&rgba[4 * i], 3, &rgba[3 * i]);
        rgba.resize(3 * count);
        return rgba;
    }

    void fill_report() {
        report_.damage = data_.surface->field.cache().damage();
        report_.backend = backend_name(context_.backend());
        report_.gl_version = context_.gl_version();
        report_.gl_renderer = context_.gl_renderer();
        report_.seconds = steps_.list();
    }

    const FilmOptions& options_;
    RenderOptions render_;  ///< of the frame: exaggeration changes
    FrameOutput& output_;
    unsigned threads_;
    bool in_parts_;  ///< as a picture of this size is: frames that are larger than what is drawn at once
    Steps steps_;
    FilmReport report_;
    std::shared_future<AtmosphereTables> tables_;
    Context context_;
    GlobeData data_;
    FlightPath path_;
    FlightClearance clearance_;
    GlobeLooks looks_;
    LiveMesh mesh_;
    Framebuffer target_;
    std::future<ViewTable> air_;  // last: their ends wait for work that uses the above
    std::future<void> writing_;
};

}  // namespace

FilmReport draw_film(const FilmOptions& options, const FlightPlan& plan, FrameOutput& output) {
    return Film(options, plan, output).draw();
}

}  // namespace render
