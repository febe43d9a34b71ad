// What keys, buttons and panels make a viewer do.

#include <algorithm>
#include <chrono>
#include <iostream>
#include <string>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "render/app/temporary_names.h"
#include "render/app/view/view_line.h"
#include "render/app/view/viewer_session.h"

namespace render {

void ViewerSession::save_picture() {
    const auto now = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
    std::string name = "octaglobe-" + planet::iso8601_from_utc(now) + ".png";
    std::erase(name, ':');
    const std::vector<std::uint8_t> rgb = frame_.rgb();
    try {
        planet::ImageWriter writer(name, frame_.width(), frame_.height(), 3, planet::SampleType::uint8,
                                   {.make_file = make_listed});
        writer.write_rows(rgb.data(), frame_.height());
        writer.finish();
        notice("Saved " + name);
    } catch (const planet::Error& error) {
        notice(error.what());  // the flight goes on
    }
}

void ViewerSession::toggle_frozen() {
    if (frozen_)
        frozen_.reset();
    else
        frozen_ = camera_.culling({0, 0, camera_.width, camera_.height}, data_.surface->occluder_radius());
    look_changed_ = true;
}

void ViewerSession::copy_view() {
    const std::string line =
        render_line(resting_.value_or(options_of_pose(render_, *data_.surface, navigator_->pose())));
    window_.set_clipboard(line);
    std::cout << line << std::endl;
    notice("Copied: " + line);
}

void ViewerSession::set_time(planet::UtcTime time) {
    render_.time = time;
    look_changed_ = true;
}

void ViewerSession::set_exaggeration(double factor) {
    render_.exaggeration = data_.surface->exaggeration = std::clamp(factor, 0.0, 100.0);
    mesh_->place_anew();
    moved_at_ = window_.seconds();
    look_changed_ = true;
}

void ViewerSession::show_layers() {
    looks_.set_layers(data_.layers.shown(render_), data_.layers.needs_stencil());
    look_changed_ = true;
}

void ViewerSession::toggle(Overlay overlay) {
    // A triangle has one colour.
    constexpr auto colors = static_cast<std::uint32_t>(Overlay::levels) |
                            static_cast<std::uint32_t>(Overlay::segments) |
                            static_cast<std::uint32_t>(Overlay::deviations);
    const auto bit = static_cast<std::uint32_t>(overlay);
    render_.show = (bit & colors) != 0 ? (render_.show & (~colors | bit)) ^ bit : render_.show ^ bit;
    looks_.set_overlay(overlays_of(render_));
    show_layers();
}

void ViewerSession::go_to_typed() {
    try {
        const planet::Geodetic place = place_from_text(panels_.go_to_text);
        const double clearance = navigator_->clearance();
        places_.push_back(navigator_->sight(lens()));
        navigator_->fly_to(planet::normal_from_geodetic(place.latitude, place.longitude),
                           std::clamp(clearance, 2000.0, 40'000.0), lens());
        panels_.go_to = false;
        panels_.go_to_answer.clear();
    } catch (const planet::Error& error) {
        panels_.go_to_answer = error.what();
    }
}

void ViewerSession::act(Action action) {
    using enum Action;
    using namespace std::chrono_literals;
    const auto fly = [&](auto&& flight) {
        places_.push_back(navigator_->sight(lens()));
        flight();
    };
    switch (action) {
        case help:
            panels_.help = !panels_.help;
            break;
        case settings:
            panels_.settings = !panels_.settings;
            break;
        case statistics:
            panels_.statistics = !panels_.statistics;
            break;
        case panels:
            panels_.shown = !panels_.shown;
            break;
        case full_screen:
            window_.set_full_screen(!window_.full_screen());
            break;
        case close:
            if (panels_.help || panels_.go_to)
                panels_.help = panels_.go_to = false;
            else if (window_.full_screen())
                window_.set_full_screen(false);
            else
                panels_.settings = panels_.statistics = false;
            break;
        case leave:
            leaving_ = true;
            break;
        case home:
            fly([&] { navigator_->fly_home(lens()); });
            break;
        case north_up:
            navigator_->north_up(lens());
            break;
        case look_down:
            navigator_->look_down(lens());
            break;
        case go_to:
            panels_.go_to = true;
            panels_.go_to_answer.clear();
            break;
        case back:
            if (places_.empty()) break;
            navigator_->fly_to(places_.back(), lens());
            places_.pop_back();
            break;
        case copy_line:
            copy_view();
            break;
        case save_file:
            save_picture();
            break;
        case place_format:
            place_format_ = static_cast<PlaceFormat>((static_cast<int>(place_format_) + 1) % place_formats);
            break;
        case hour_back:
            set_time(render_.time - 1h);
            break;
        case hour_on:
            set_time(render_.time + 1h);
            break;
        case day_back:
            set_time(render_.time - 24h);
            break;
        case day_on:
            set_time(render_.time + 24h);
            break;
        case flatter:
            set_exaggeration(std::max(render_.exaggeration - 0.5, 0.0));
            break;
        case steeper:
            set_exaggeration(render_.exaggeration + 0.5);
            break;
        case show_mesh:
            toggle(Overlay::mesh);
            break;
        case show_levels:
            toggle(Overlay::levels);
            break;
        case show_curve:
            toggle(Overlay::curve);
            break;
        case freeze_culling:
            toggle_frozen();
            break;
        case show_graticule:
            toggle(Overlay::graticule);
            break;
        case show_coastlines:
            toggle(Overlay::coastlines);
            break;
        case show_borders:
            toggle(Overlay::borders);
            break;
        case show_relief:
            toggle(Overlay::relief);
            break;
        case show_segments:
            toggle(Overlay::segments);
            break;
        case show_deviations:
            toggle(Overlay::deviations);
            break;
    }
}

}  // namespace render
