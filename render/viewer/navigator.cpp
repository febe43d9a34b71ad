#include "render/viewer/navigator.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geodetic.h"

namespace render {

namespace {

using planet::wgs84;

constexpr double double_click_s = 0.4, double_click_px = 6;
constexpr double notch = 0.24;         // natural logarithm of the distance
constexpr double zoom_time_s = 0.09;   // in which two thirds of a zoom happen
constexpr double turn_per_px = 0.005;  // rad
constexpr double held_still_s = 0.08;  // a hand that rests so long before it lets go throws nothing
constexpr double slow_frame_s = 0.12, longest_step_s = 0.1;
constexpr double least_range_m = 3;

}  // namespace

void Navigator::stop() {
    thrown_ = false;
    glide_.stop();
    flight_.reset();
    zoom_left_ = 0;
}

void Navigator::set_pose(const Pose& pose) {
    stop();
    drag_ = Drag::none;
    pose_ = pose;
}

void Navigator::keep_above_ground() {
    pose_ = lifted(pose_, ground_.height(pose_.normal) + least_clearance_m);
}

std::optional<Navigator::Anchor> Navigator::anchor_at(const glm::dvec2& pixel, const Lens& lens) const {
    const auto point = ground_.pick(pose_.eye(), ray(pose_, lens, pixel));
    return point ? std::optional(Anchor{*point, pixel}) : std::nullopt;
}

Navigator::Anchor Navigator::middle(const Lens& lens) const {
    if (const auto anchor = anchor_at(lens.middle(), lens)) return *anchor;
    const glm::dvec3 below = planet::ecef_from_normal(wgs84, pose_.normal, {ground_.height(pose_.normal)});
    return {below, pixel_of_point(pose_, lens, below).value_or(lens.middle())};
}

void Navigator::handle(const InputEvent& event, const Lens& lens) {
    using enum InputEvent::Kind;
    if (event.kind == button_down) {
        begin_drag(event, lens);
    } else if (event.kind == motion && drag_ != Drag::none) {
        drag_to(event, lens);
    } else if (event.kind == button_up) {
        thrown_ = drag_ == Drag::ground && event.seconds - last_seconds_ <= held_still_s;
        if (!thrown_) glide_.stop();
        drag_ = Drag::none;
    } else if (event.kind == wheel && event.wheel != 0) {
        begin_zoom(event.wheel, {event.x, event.y}, lens);
    }
}

void Navigator::begin_drag(const InputEvent& event, const Lens& lens) {
    stop();
    noted_ = pose_;
    const glm::dvec2 pixel(event.x, event.y);
    const auto anchor = anchor_at(pixel, lens);
    const bool left = event.button == MouseButton::left && !event.control && !event.shift;
    const bool twice = left && event.seconds - pressed_seconds_ < double_click_s &&
                       glm::distance(pixel, pressed_pixel_) < double_click_px;
    pressed_seconds_ = left && !twice ? event.seconds : -1;
    pressed_pixel_ = last_pixel_ = pixel;
    last_seconds_ = event.seconds;
    if (twice && anchor) {
        drag_ = Drag::none;
        const planet::NormalPosition at = planet::position_from_ecef(wgs84, anchor->point);
        fly_to(at.normal, std::max(0.3 * glm::distance(pose_.eye(), anchor->point), 10 * least_range_m), lens);
    } else if (left) {
        drag_ = anchor ? Drag::ground : Drag::sky;
        anchor_ = anchor.value_or(Anchor{});
        sky_ = ray(pose_, lens, pixel);
    } else {
        drag_ = Drag::orbit;
        anchor_ = anchor ? *anchor : middle(lens);
    }
}

void Navigator::drag_to(const InputEvent& event, const Lens& lens) {
    const glm::dvec2 pixel(event.x, event.y), way = pixel - last_pixel_;
    const Pose before = pose_;
    if (drag_ == Drag::ground) {
        pose_ = hold(pose_, lens, anchor_.point, pixel, Compass::kept).pose;
    } else if (drag_ == Drag::sky) {
        pose_ = turn_to(pose_, lens, sky_, pixel).pose;
        pose_.pitch = std::min(pose_.pitch, std::max(highest_pitch(pose_.h), before.pitch));
    } else if (const auto at = pixel_of_point(pose_, lens, anchor_.point)) {
        pose_ = orbited(pose_, lens, anchor_.point, *at, -way.x * turn_per_px, -way.y * turn_per_px);
    }
    keep_above_ground();
    last_pixel_ = pixel;
    last_seconds_ = event.seconds;
}

void Navigator::begin_zoom(double notches, const glm::dvec2& pixel, const Lens& lens) {
    const double left = zoom_left_;
    stop();
    zoom_anchor_ = anchor_at(pixel, lens).value_or(middle(lens));
    zoom_left_ = (left * notches < 0 ? left : 0) - notch * notches;
}

void Navigator::zoom(double factor, const Lens& lens) {
    stop();
    zoom_anchor_ = middle(lens);
    zoom_left_ = std::log(factor);
}

// Events carry the time when they are looked at, which after a slow frame is the same for all: what a hand did is known by
// frame, and after a slow one not whether it moved to the end.
void Navigator::note_throw(double seconds) {
    if (drag_ != Drag::ground && !thrown_) return;
    glide_.note(noted_, pose_, seconds);
    noted_ = pose_;
    if (thrown_ && seconds > slow_frame_s) glide_.stop();
    thrown_ = false;
}

void Navigator::advance(double since_last, const Lens& lens, const Steering& steering) {
    note_throw(since_last);
    const double seconds = std::min(since_last, longest_step_s);
    if (steering.any()) {
        stop();
        steer(seconds, lens, steering);
    }
    if (flight_) {
        flown_ += seconds;
        pose_ = pose_of(flight_->at(flown_));
        if (flown_ >= flight_->duration()) flight_.reset();
    }
    if (zoom_left_ != 0) {
        double step = zoom_left_ * (1 - std::exp(-seconds / zoom_time_s));
        if (std::abs(zoom_left_ - step) < 1e-3) step = zoom_left_;
        zoom_left_ -= step;
        const double distance = glm::distance(pose_.eye(), zoom_anchor_.point);
        if (step > 0 || distance > least_range_m)
            pose_ = zoomed(pose_, lens, zoom_anchor_.point, zoom_anchor_.pixel, std::exp(step), Compass::kept);
        else
            zoom_left_ = 0;
    }
    if (drag_ == Drag::none && glide_.moving())
        pose_ = glide_.advance(pose_, lens, clearance(), seconds, Compass::kept);
    keep_above_ground();
}

void Navigator::steer(double seconds, const Lens& lens, const Steering& s) {
    const double pace = std::clamp(clearance(), 20.0, 0.6 * wgs84.a) * 1.2 * seconds;
    const double sine = std::sin(pose_.heading), cosine = std::cos(pose_.heading);
    if (s.right != 0 || s.forward != 0)
        pose_ = moved(pose_, pace * (s.right * cosine + s.forward * sine), pace * (s.forward * cosine - s.right * sine),
                      Compass::kept);
    if (s.turn == 0 && s.tilt == 0 && s.nearer == 0) return;
    const Anchor about = middle(lens);
    if (s.turn != 0 || s.tilt != 0)
        pose_ = orbited(pose_, lens, about.point, about.pixel, s.turn * seconds, s.tilt * seconds);
    if (s.nearer != 0 && (s.nearer < 0 || glm::distance(pose_.eye(), about.point) > least_range_m))
        pose_ = zoomed(pose_, lens, about.point, about.pixel, std::exp(-1.5 * s.nearer * seconds), Compass::kept);
}

Sight Navigator::sight(const Lens& lens) const {
    // Where there is only sky, the view is about a point in it: flights must begin where the eye is.
    const glm::dvec3 ahead = ray(pose_, lens, lens.middle());
    const auto hit = anchor_at(lens.middle(), lens);
    const Anchor at = hit.value_or(Anchor{pose_.eye() + 0.3 * clearance() * ahead, lens.middle()});
    const planet::NormalPosition place = planet::position_from_ecef(wgs84, at.point);
    const glm::dvec3 back = pose_.eye() - at.point;
    // The same eye as the place sees it: pose_from() does to the place's frame what it does to the eye's.
    const double range = glm::length(back);
    Pose seen = pose_from(at.point, -back / range, ray(pose_, lens, lens.middle() - glm::dvec2(0, lens.focal)));
    return {place.normal, place.h.m, range, seen.heading, seen.pitch};
}

void Navigator::fly_to(const Sight& to, const Lens& lens) {
    const Sight from = sight(lens);
    stop();
    flight_ = Flight(from, to);
    flown_ = 0;
}

void Navigator::fly_to(const glm::dvec3& normal, double range, const Lens& lens) {
    Sight to = sight(lens);
    to.normal = normal;
    to.h = ground_.height(normal);
    to.range = range;
    // No flatter than where nothing hides the place.
    to.pitch = std::min(to.pitch, -20 * planet::degrees);
    fly_to(to, lens);
}

void Navigator::fly_home(const Lens& lens) {
    const double fov = 2 * std::atan(0.5 * std::min(lens.width, lens.height) / lens.focal);
    const Sight from = sight(lens);
    fly_to({from.normal, 0, whole_globe_range(fov), 0, -90 * planet::degrees}, lens);
}

void Navigator::north_up(const Lens& lens) {
    Sight to = sight(lens);
    to.heading = 0;
    fly_to(to, lens);
}

void Navigator::look_down(const Lens& lens) {
    Sight to = sight(lens);
    to.pitch = -90 * planet::degrees;
    fly_to(to, lens);
}

}  // namespace render
