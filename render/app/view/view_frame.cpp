#include "render/app/view/view_frame.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace render {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void make_target(Framebuffer& target, int width, int height, const Framebuffer::Options& options) {
    if (target && target.width() == width && target.height() == height && target.samples() == options.samples) return;
    target = Framebuffer();  // before another takes memory
    target = Framebuffer(width, height, options);
}

/// The same view in fewer pixels.
Camera scaled(Camera camera, double scale) {
    const int width = std::max(static_cast<int>(std::lround(camera.width * scale)), 1);
    camera.focal_px *= static_cast<double>(width) / camera.width;
    camera.height = std::max(static_cast<int>(std::lround(camera.height * scale)), 1);
    camera.width = width;
    return camera;
}

}  // namespace

double ViewFrame::draw_moving(GlobeLooks& looks, const GlobeLooks::Frame& frame, double scale) {
    const auto start = Clock::now();
    settled_ = still_shown_ = false;
    const Camera camera = scaled(frame.camera, scale);
    make_target(moving_, camera.width, camera.height, looks.target_options(1));
    moving_camera_ = camera;
    moving_scale_ = static_cast<double>(camera.width) / frame.camera.width;
    moving_.bind();
    moving_.clear(0, 0, 0, 1);
    looks.draw({.camera = camera,
                .part = {0, 0, camera.width, camera.height},
                .exaggeration = frame.exaggeration,
                .patches = frame.patches,
                .ground = frame.ground,
                .morph_reach = frame.morph_reach,
                .relief = frame.relief,
                .pixel_scale = moving_scale_ * frame.pixel_scale,
                .labels = false},
               moving_);
    gl().Finish();
    return seconds_since(start);
}

void ViewFrame::begin_settled(int samples) {
    samples_ = samples;
    rows_done_ = 0;
    settled_ = false;
}

bool ViewFrame::draw_settled(GlobeLooks& looks, const GlobeLooks::Frame& frame, double seconds) {
    const auto start = Clock::now();
    const int width = frame.camera.width, height = frame.camera.height;
    make_target(next_, width, height, looks.target_options(samples_));
    next_.bind();
    gl().Enable(GL_SCISSOR_TEST);
    while (rows_done_ < height && (rows_done_ == 0 || seconds_since(start) < seconds)) {
        const int rows = std::min(rows_at_once_ > 0 ? rows_at_once_ : 32, height - rows_done_);
        const auto band = Clock::now();
        gl().Scissor(0, rows_done_, width, rows);
        next_.clear(0, 0, 0, 1);
        looks.draw_opaque(frame);
        gl().Finish();
        const double each = seconds_since(band) / rows;
        rows_at_once_ = std::clamp(static_cast<int>(0.5 * seconds / std::max(each, 1e-9)), 8, height);
        rows_done_ += rows;
    }
    gl().Disable(GL_SCISSOR_TEST);
    // At once: with several samples a pixel llvmpipe draws a row beyond the scissor, and rows would blend twice.
    if (rows_done_ >= height && !settled_) {
        looks.draw_blended(frame, next_);
        std::swap(still_, next_);
        still_camera_ = frame.camera;
        settled_ = still_shown_ = true;
    }
    return settled_;
}

std::optional<glm::dvec3> ViewFrame::point_at(const glm::dvec2& pixel) const {
    if (!shown()) return std::nullopt;
    const Camera& camera = still_shown_ ? still_camera_ : moving_camera_;
    const glm::ivec2 at(glm::floor(pixel / pixel_size()));
    if (at.x < 0 || at.y < 0 || at.x >= camera.width || at.y >= camera.height) return std::nullopt;
    const auto depth = static_cast<double>(shown().read_depth(at.x, at.y));
    if (!(depth > 0)) return std::nullopt;
    return ecef_from_screen(camera, {glm::dvec2(at) + shown().depth_sample(), depth});
}

void ViewFrame::show(int width, int height) const {
    if (shown()) shown().show_in_window(width, height);
}

std::vector<std::uint8_t> ViewFrame::rgb() const {
    const std::vector<std::uint8_t> rgba = shown().read_rgba8();
    std::vector<std::uint8_t> rgb;
    rgb.reserve(rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < rgba.size(); i += 4) rgb.insert(rgb.end(), &rgba[i], &rgba[i] + 3);
    return rgb;
}

}  // namespace render
