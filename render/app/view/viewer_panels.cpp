// What the viewer's panels say.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "planet/geodesy/geodetic.h"
#include "render/app/figures.h"
#include "render/app/view/viewer_session.h"

namespace render {

namespace {

using planet::degrees;
using planet::wgs84;

/// As long as it takes to read.
constexpr double least_notice_s = 4, letter_s = 0.06;

Plot plot(const std::string& name, const std::deque<double>& values, float marked) {
    Plot p{.name = name, .unit = "ms", .values{values.begin(), values.end()}, .marked = marked};
    float most = 2 * marked;
    for (const float v : p.values) most = std::max(most, v);
    p.top = most;
    return p;
}

struct OverlaySwitch {
    Overlay overlay;
    const char* name;
    Action action;
};
constexpr OverlaySwitch overlay_switches[] = {
    {Overlay::graticule, "Graticule", Action::show_graticule},
    {Overlay::coastlines, "Coastlines", Action::show_coastlines},
    {Overlay::borders, "Borders", Action::show_borders},
    {Overlay::relief, "Heights as colours", Action::show_relief},
    {Overlay::mesh, "Wireframe", Action::show_mesh},
    {Overlay::levels, "Bisection levels", Action::show_levels},
    {Overlay::deviations, "Deviations", Action::show_deviations},
    {Overlay::segments, "Segments", Action::show_segments},
    {Overlay::curve, "Sierpinski curve", Action::show_curve},
};

Action action_of_switch(const std::string& name) {
    for (const OverlaySwitch& s : overlay_switches)
        if (name == s.name) return s.action;
    return Action::freeze_culling;
}

std::string text_of_fact(const char* name, const std::string& value) {
    return std::string(name) + "\t" + value;
}

}  // namespace

void ViewerSession::notice(std::string text) {
    notice_ends_ = window_.seconds() + std::max(least_notice_s, letter_s * static_cast<double>(text.size()));
    panels_.notice = std::move(text);
}

void ViewerSession::fill_panels() {
    const double left = notice_ends_ - window_.seconds();
    if (left < 0) panels_.notice.clear();
    panels_.notice_fade = static_cast<float>(std::clamp(2 * left, 0.0, 1.0));
    if (!panels_.shown) return;
    fill_status();
    if (panels_.statistics) fill_statistics();
    if (panels_.settings) fill_settings();
}

void ViewerSession::fill_settings() {
    const auto day = std::chrono::floor<std::chrono::days>(render_.time);
    const std::chrono::year_month_day date(day);
    panels_.time_text = planet::iso8601_from_utc(render_.time);
    panels_.day_hours = static_cast<float>(std::chrono::duration<double, std::ratio<3600>>(render_.time - day).count());
    panels_.year_day = static_cast<float>((day - std::chrono::sys_days{date.year() / 1 / 1}).count() + 1);
    panels_.exaggeration = static_cast<float>(render_.exaggeration);
    panels_.layers.clear();
    panels_.modes.clear();
    for (const OverlaySwitch& s : overlay_switches)
        (s.overlay < Overlay::graticule ? panels_.modes : panels_.layers)
            .push_back({s.name, key_text(s.action), render_.shows(s.overlay)});
    panels_.own_layers.clear();
    for (std::size_t i = render_.layers.size(); i-- > 0;) {
        const LayerOptions& layer = render_.layers[i];
        const glm::vec3 color = data_.layers.own()[i].layer.style.color;
        panels_.own_layers.push_back({.name = data_.layers.own()[i].name,
                                      .color = {color.r, color.g, color.b},
                                      .on = layer.shown,
                                      .opacity = static_cast<float>(layer.opacity)});
    }
    panels_.modes.push_back({"Frozen culling", key_text(Action::freeze_culling), frozen_.has_value()});
}

void ViewerSession::fill_status() {
    const Pose& pose = navigator_->pose();
    const Lens lens = this->lens();
    panels_.compass = static_cast<float>(pose.heading);
    panels_.tilt = static_cast<float>(pose.pitch + 90 * degrees);
    panels_.eye_line = "Eye " + length_text(navigator_->clearance()) + " above ground";
    const auto pixel_m = [&](const glm::dvec3& point) { return glm::distance(point, pose.eye()) / lens.focal; };
    panels_.cursor_place = cursor_.x >= 0 ? text_under_cursor(pose, lens) : "";
    panels_.scale_px = 0;
    if (const auto middle = pick_.first_hit(pose.eye(), ray(pose, lens, lens.middle()))) {
        const ScaleBar bar = scale_bar(pixel_m(*middle), 0.16 * lens.width);
        panels_.scale_px = static_cast<float>(bar.pixels);
        panels_.scale_text = bar.text;
    }
    const planet::Residency& residency = mesh_->residency();
    panels_.activity.clear();
    if (residency.damaged > 0) panels_.activity = grouped(residency.damaged) + " damaged tiles in view";
    if (residency.pending > 0)
        panels_.activity = "loading " + grouped(residency.pending) + " tiles";
    else if (mesh_->patches().missing() > 0 || (resting_ && !frame_.settled()))
        panels_.activity = "drawing";
    if (frozen_) panels_.activity = "culling is frozen";
}

/// Place and heights; "mesh" before those of an imported one.
std::string ViewerSession::text_under_cursor(const Pose& pose, const Lens& lens) {
    const auto mesh = mesh_at(cursor_);
    const auto at = mesh ? mesh : pick_.first_hit(pose.eye(), ray(pose, lens, cursor_));
    if (!at) return "";
    const planet::NormalPosition p = planet::position_from_ecef(wgs84, *at);
    const double pixel_m = glm::distance(*at, pose.eye()) / lens.focal;
    const std::string place = place_text(planet::geodetic_from_normal(p.normal), place_format_, pixel_m) + "     ";
    const planet::GeoidUndulation N =
        data_.surface->geoid ? data_.surface->geoid->undulation(p.normal) : planet::GeoidUndulation{};
    // Never exaggerated. Of the ground: that of the finest surface, which `octaglobe query height` answers.
    if (mesh && render_.exaggeration == 0) return place + "mesh";
    const double height =
        mesh ? (p.h - N).m / render_.exaggeration : static_cast<double>(data_.surface->field.height(p.normal));
    return place + (mesh ? "mesh " : "") + heights_text({height}, planet::OrthometricHeight{height} + N, pixel_m);
}

void ViewerSession::fill_statistics() {
    panels_.plots = {plot("Frame", frame_seconds_, 1000.0f / 60), plot("Mesh", update_seconds_, 1000.0f / 60)};
    const planet::ResidentCounts counts = mesh_->counts();
    panels_.facts = {
        text_of_fact("Triangles", grouped(mesh_->segments().leaf_count())),
        text_of_fact("Deviation",
                     four_digits(mesh_->deviation_m()) + " m, " + four_digits(mesh_->pixel_deviation()) + " px"),
        text_of_fact("Tiles", grouped(counts.tiles) + ", " + bytes_text(counts.tile_bytes)),
        text_of_fact("Graphics", bytes_text(looks_.terrain().bytes())),
        text_of_fact("Resolution", std::to_string(frame_.width()) + " x " + std::to_string(frame_.height())),
    };
}

// The panel has the highest layer first, the options the lowest.
void ViewerSession::take_layer_changes() {
    for (std::size_t row = 0; row < panels_.own_layers.size(); ++row) {
        LayerRow& changed = panels_.own_layers[row];
        if (!std::exchange(changed.changed, false)) continue;
        const std::size_t i = render_.layers.size() - 1 - row;
        LayerOptions& layer = render_.layers[i];
        layer.shown = changed.on;
        layer.opacity = std::round(100 * static_cast<double>(changed.opacity)) / 100;
        const std::size_t other = i + static_cast<std::size_t>(std::exchange(changed.raise, 0));
        if (other != i && other < render_.layers.size()) {
            std::swap(layer, render_.layers[other]);
            data_.layers.swap(i, other);
        }
        show_layers();
        return;  // what the rows are of may have changed
    }
}

void ViewerSession::take_panel_changes() {
    if (std::exchange(panels_.north_pressed, false)) navigator_->north_up(lens());
    if (std::exchange(panels_.go_to_entered, false)) go_to_typed();
    if (std::exchange(panels_.time_changed, false)) {
        const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(render_.time));
        const auto day =
            std::chrono::sys_days{date.year() / 1 / 1} + std::chrono::days(std::lround(panels_.year_day) - 1);
        set_time(day + std::chrono::milliseconds(std::llround(static_cast<double>(panels_.day_hours) * 3.6e6)));
    }
    for (std::vector<Switch>* list : {&panels_.layers, &panels_.modes})
        for (Switch& changed : *list)
            if (std::exchange(changed.changed, false)) act(action_of_switch(changed.name));
    take_layer_changes();
    if (std::exchange(panels_.exaggeration_changed, false))
        set_exaggeration(std::round(10 * static_cast<double>(panels_.exaggeration)) / 10);
}

}  // namespace render
