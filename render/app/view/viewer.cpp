#include "render/app/view/viewer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "render/app/temporary_names.h"
#include "render/app/view/view_line.h"
#include "render/app/view/viewer_session.h"

namespace render {

namespace {

using planet::wgs84;

constexpr double rest_after_s = 0.25;
constexpr double still_budget_s = 0.04;  // of drawing the settled picture, before input is looked at again
constexpr double preview_every_s = 0.4;  // while what a picture at rest needs is on its way
constexpr std::size_t patches_a_frame = 24;

/// Resident memory now, bytes.
std::uint64_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total = 0, resident = 0;
    statm >> total >> resident;
    return resident * 4096;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

bool is_software(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "SWR", "Software"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

}  // namespace

ViewerSession::Stage ViewerSession::open_stage(const ViewerOptions& options) {
    auto window = open_window({.title = "Octaglobe",
                               .width = options.render.size.width,
                               .height = options.render.size.height,
                               .full_screen = options.full_screen,
                               .debug = gl_checks});
    Context context = Context::adopt(window->take_context());
    window->set_swap_interval(options.frames > 0 ? 0 : 1);
    return {std::move(window), std::move(context)};
}

ViewerSession::ViewerSession(const ViewerOptions& options)
    : options_(options), render_(options.render), stage_(open_stage(options)), air_(render_.thread_count()) {
    panels_.shown = !options.bare;
    panels_.help_groups = help_groups();
    set_reversed_depth();
}

ViewerReport ViewerSession::run() {
    if (load()) {
        begin();
        while (step()) {
        }
        fill_report();
    }
    return std::move(report_);
}

void ViewerSession::fill_report() {
    report_.frame_seconds_median = median(all_frame_seconds_);
    report_.update_seconds_median = median(all_update_seconds_);
    for (const double s : all_frame_seconds_) report_.frame_seconds_max = std::max(report_.frame_seconds_max, s);
    report_.triangles = mesh_->segments().leaf_count();
    report_.gpu_bytes = looks_.terrain().bytes();
    report_.tiles = mesh_->counts();
    report_.deviation_max_m = mesh_->deviation_m();
    report_.pixel_deviation_max = mesh_->pixel_deviation();
    report_.view = render_line(resting_.value_or(options_of_pose(render_, *data_.surface, navigator_->pose())));
    report_.layers = data_.layers.report();
    report_.damage = data_.surface->field.cache().damage();
}

/// Shows how far loading is. False if the window was closed meanwhile.
bool ViewerSession::load() {
    loading_.emplace(render_);
    while (!loading_->ready()) {
        if (window_.closed()) return false;
        for (const InputEvent& event : window_.wait(0.05))
            if (action_of(event) == Action::leave) return false;
        const GlobeLoading::Progress progress = loading_->progress();
        panels_.progress = "Loading: " + progress.step;
        panels_.progress_part = std::isnan(progress.part) ? 0 : static_cast<float>(progress.part);
        gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
        gl().Viewport(0, 0, window_.width(), window_.height());
        gl().ClearColor(0, 0, 0, 1);
        gl().Clear(GL_COLOR_BUFFER_BIT);
        window_.draw_panels(panels_);
        window_.swap();
    }
    data_ = loading_->take();
    loading_.reset();
    panels_.progress.clear();
    return !window_.closed();
}

void ViewerSession::begin() {
    looks_.upload(data_.imagery);
    looks_.link(data_.stars, data_.noise, overlays_of(render_));
    show_layers();
    const Limits& limits = stage_.context.limits();
    mesh_.emplace(render_, *data_.surface, std::min<std::size_t>(2048, static_cast<std::size_t>(limits.array_layers)));
    pace_.emplace(is_software(stage_.context.gl_renderer()), render_.max_triangles.value_or(~std::size_t{0}));
    render_.size = {window_.width(), window_.height()};
    if (!render_.scale) render_.scale = std::clamp(std::round(100 * window_.scale()) / 100, 0.5, 4.0);
    const DrawnSurface& surface = *data_.surface;
    navigator_.emplace(
        Ground{[this](const glm::dvec3& origin, const glm::dvec3& way) { return point_under(origin, way); },
               [&surface](const glm::dvec3& normal) { return surface.ground(normal); }},
        pose_of_camera(surface.camera(render_)));
    // The air of the first frame is worth waiting for.
    camera_ = lens().camera(navigator_->pose());
    while (!air_.is_for(camera_.eye, render_.time)) {
        if (auto table = air_.update(camera_.eye, render_.time, false))
            looks_.set_sky(air_.tables(), *std::move(table), render_.time);
        else
            static_cast<void>(window_.wait(0.005));
    }
    last_step_ = last_swap_ = window_.seconds();
    moved_at_ = last_step_ - 1;
    report_.gl_version = stage_.context.gl_version();
    report_.gl_renderer = stage_.context.gl_renderer();
    report_.context = window_.context_way();
    warn();
}

/// Of layers, in the window and on standard error.
void ViewerSession::warn() {
    std::string lines;
    for (const LayerReport& layer : data_.layers.report())
        if (!layer.warning.empty()) lines += (lines.empty() ? "" : "\n") + layer.warning;
    if (lines.empty()) return;
    warn_of_layers(data_.layers.report());
    notice(lines);
}

Lens ViewerSession::lens() const {
    return {focal_length_px(render_.fov, render_.size.width, render_.size.height), render_.size.width,
            render_.size.height};
}

/// What a hand takes hold of: the ground, or an imported mesh that is drawn off it.
std::optional<glm::dvec3> ViewerSession::point_under(const glm::dvec3& origin, const glm::dvec3& way) {
    const auto pixel = pixel_of_direction(navigator_->pose(), lens(), way);
    if (const auto mesh = pixel ? mesh_at(*pixel) : std::nullopt) return origin + glm::dot(*mesh - origin, way) * way;
    return pick_.first_hit(origin, way);
}

/// Where the picture shows an imported mesh that is so far off the ground that it can be told from it, ecef. No ray is
/// followed through its triangles, of which there may be millions: its depth was drawn.
std::optional<glm::dvec3> ViewerSession::mesh_at(const glm::dvec2& pixel) const {
    const bool meshes = std::ranges::any_of(
        render_.layers, [](const LayerOptions& l) { return l.shown && l.opacity > 0 && is_mesh(l); });
    if (!meshes) return std::nullopt;
    const auto point = frame_.point_at(pixel);
    if (!point) return std::nullopt;
    const double distance = glm::distance(camera_.eye, *point);
    const auto ground = planet::SegmentSurface(mesh_->segments()).point_at(planet::normal_from_ecef(wgs84, *point));
    const double ground_off = ground ? glm::distance(*ground, *point) : distance;
    const double pixels = 2 * frame_.pixel_size() + mesh_->pixel_deviation();
    if (ground_off < depth_resolution(distance) + pixels * distance / camera_.focal_px) return std::nullopt;
    return point;
}

/// How long there is nothing to do but to wait for the user. Other threads need the processor, too.
double ViewerSession::patience() const {
    if (!resting_ || worked_ || counts_frames() || save_next_) return 0;
    const bool waits = !frame_.settled() || panels_.wants_frame || automatic() || window_.seconds() < notice_ends_;
    return waits ? 0.016 : 0.5;
}

/// One turn of the loop; false when it is over.
bool ViewerSession::step() {
    const std::vector<InputEvent> events = window_.wait(patience());
    input_ = false;
    const double now = window_.seconds(), dt = now - last_step_;
    last_step_ = now;
    if (window_.closed() || leaving_) return false;
    if (window_.width() == 0 || window_.height() == 0) {  // an icon
        static_cast<void>(window_.wait(0.2));
        return true;
    }
    if (const PictureSize size{window_.width(), window_.height()}; size != render_.size) {
        render_.size = size;
        moved_at_ = now;
        input_ = true;
    }
    for (const InputEvent& event : events) {
        input_ = true;
        cursor_ = {event.x, event.y};
        if (const auto action = action_of(event))
            act(*action);
        else
            navigator_->handle(event, lens());
    }
    take_panel_changes();
    step_view(dt);
    update_globe();
    draw();
    present();
    return !finish_when_done();
}

Steering ViewerSession::steering() const {
    const auto axis = [&](Key less, Key more) {
        return (window_.held(more) ? 1.0 : 0.0) - (window_.held(less) ? 1.0 : 0.0);
    };
    const bool shift = window_.held(static_cast<Key>(340)) || window_.held(static_cast<Key>(344));
    const double across = axis(Key::left, Key::right), along = axis(Key::down, Key::up);
    const double nearer = std::clamp(
        axis(Key::page_down, Key::page_up) + axis(Key::minus, Key::equal) + axis(Key::keypad_minus, Key::keypad_plus),
        -1.0, 1.0);
    return shift ? Steering{.nearer = nearer, .turn = across, .tilt = along}
                 : Steering{.right = across, .forward = along, .nearer = nearer};
}

void ViewerSession::step_view(double dt) {
    navigator_->advance(dt, lens(), steering());
    if (options_.turn != 0 && counts_frames()) {
        const Sight sight = navigator_->sight(lens());
        Sight turned = sight;
        turned.heading += options_.turn;
        navigator_->set_pose(pose_of(turned));
    }
    const Camera camera = lens().camera(navigator_->pose());
    const bool same = camera.eye == camera_.eye && camera.view_from_ecef == camera_.view_from_ecef &&
                      camera.width == camera_.width && camera.height == camera_.height;
    if (!same) moved_at_ = window_.seconds();
    if (!same || look_changed_) {
        resting_.reset();
        started_still_ = false;
    }
    camera_ = camera;
    if (!resting_ && window_.seconds() - moved_at_ > rest_after_s && !navigator_->moves()) {
        resting_ = options_of_pose(render_, *data_.surface, navigator_->pose());
        look_changed_ = true;
    }
}

void ViewerSession::update_globe() {
    const Camera camera = shown_camera();
    LiveMesh::Wanted wanted{.camera = camera, .at_rest = resting_.has_value(), .max_triangles = pace_->max_triangles()};
    wanted.culling = frozen_;
    mesh_changed_ = mesh_->update(wanted);
    if (mesh_changed_) pick_.follow(mesh_->segments());
    const bool patches_changed = mesh_->update_patches(mesh_changed_, resting_ ? 4 * patches_a_frame : patches_a_frame);
    if (mesh_changed_ || patches_changed || look_changed_) {
        looks_.terrain().upload(mesh_->segments(), mesh_->patches().layers());
        looks_.overlay().upload(mesh_->segments(), mesh_->tiles());
        mesh_changed_ = true;
    }
    mesh_->make_next();
    if (auto table = air_.update(camera.eye, render_.time, !resting_)) {
        looks_.set_sky(air_.tables(), *std::move(table), render_.time);
        air_changed_ = true;
    }
    if (!resting_) update_seconds_.push_back(1000 * mesh_->update_seconds());
    if (counts_frames()) all_update_seconds_.push_back(mesh_->update_seconds());
}

void ViewerSession::draw() {
    const bool changed = mesh_changed_ || air_changed_ || look_changed_;
    const Camera camera = shown_camera();
    const PicturePart whole{0, 0, camera.width, camera.height};
    DrapeGround ground = data_.surface->for_layers(mesh_->segments(), camera, whole, render_.drawn_scale());
    const GlobeLooks::Frame frame{.camera = camera,
                                  .part = whole,
                                  .exaggeration = render_.exaggeration,
                                  .patches = mesh_->patches().texture(),
                                  .ground = ground,
                                  .morph_reach = mesh_->morph_reach(),
                                  .relief = render_.shows(Overlay::relief),
                                  .pixel_scale = render_.drawn_scale()};
    const bool complete = resting_ && mesh_->complete() && air_.is_for(camera.eye, render_.time);
    picture_new_ = false;
    worked_ = true;
    if (!resting_) {
        const double seconds = frame_.draw_moving(looks_, frame, pace_->scale());
        pace_->after_frame(seconds);
        frame_seconds_.push_back(1000 * seconds);
        picture_new_ = true;
    } else if (complete && (!frame_.settled() || changed)) {
        if (changed || !started_still_) {
            frame_.begin_settled(looks_.samples(render_, camera, stage_.context.limits().samples));
            started_still_ = true;
        }
        picture_new_ = frame_.draw_settled(looks_, frame, still_budget_s);
    } else if (!complete && changed && window_.seconds() - last_preview_ > preview_every_s) {
        frame_.draw_moving(looks_, frame, pace_->scale());
        started_still_ = false;
        last_preview_ = window_.seconds();
        picture_new_ = true;
    } else {
        worked_ = false;
    }
    mesh_changed_ = air_changed_ = look_changed_ = false;
}

/// Over a moving picture, whose pixels may be larger than the window's: letters would be soft.
void ViewerSession::draw_labels() {
    const Camera camera = shown_camera();
    const PicturePart whole{0, 0, camera.width, camera.height};
    const double scale = render_.drawn_scale();
    looks_.draw_labels(camera, whole, data_.surface->for_layers(mesh_->segments(), camera, whole, scale), scale);
}

void ViewerSession::present() {
    if (!picture_new_ && !input_ && !panels_.wants_frame && !counts_frames() && !save_next_ &&
        window_.seconds() > notice_ends_ && window_.seconds() - last_swap_ < 0.5)
        return;
    gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl().Viewport(0, 0, window_.width(), window_.height());
    frame_.show(window_.width(), window_.height());
    if (!frame_.shows_still()) draw_labels();
    fill_panels();
    window_.draw_panels(panels_);
    if (save_next_) save_screenshot();
    saved_ = std::exchange(save_next_, false);
    window_.swap();
    count_errors();
    const double now = window_.seconds();
    if (counts_frames()) all_frame_seconds_.push_back(now - last_swap_);
    last_swap_ = now;
    for (auto* list : {&frame_seconds_, &update_seconds_})
        while (list->size() > 160) list->pop_front();
    ++report_.frames;
    const auto frames = static_cast<std::uint64_t>(options_.frames);
    if (report_.frames == std::max<std::uint64_t>(frames / 10, 1)) report_.memory_early_bytes = resident_bytes();
    if (report_.frames == frames) report_.memory_late_bytes = resident_bytes();
}

void ViewerSession::count_errors() {
    const std::string errors = take_gl_errors();
    if (errors.empty()) return;
    if (report_.gl_errors++ == 0) report_.first_gl_error = errors;
}

bool ViewerSession::finish_when_done() {
    const bool frames_done = options_.frames == 0 || report_.frames >= static_cast<std::uint64_t>(options_.frames);
    const bool settled = resting_ && frame_.settled() && !navigator_->moves();
    if (!automatic() || !frames_done) return false;
    if (!options_.screenshot.empty() && !saved_) {
        save_next_ = settled;  // with the panels of the settled picture, in the next frame
        return false;
    }
    report_.settled = settled;
    return true;
}

void ViewerSession::save_screenshot() {
    const int width = window_.width(), height = window_.height();
    const auto row = static_cast<std::size_t>(width) * 3;
    std::vector<std::uint8_t> pixels(row * static_cast<std::size_t>(height));
    gl().BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    gl().ReadBuffer(GL_BACK);
    gl().ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    planet::ImageWriter writer(options_.screenshot.string(), width, height, 3, planet::SampleType::uint8,
                               {.make_file = make_listed});
    for (int y = height; y-- > 0;) writer.write_rows(pixels.data() + static_cast<std::size_t>(y) * row, 1);
    writer.finish();
}

ViewerReport view_globe(const ViewerOptions& options) {
    ViewerSession session(options);
    return session.run();
}

}  // namespace render
