#include "render/viewer/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/local_frame.h"

namespace render {

namespace {

using planet::wgs84;

constexpr double pi = std::numbers::pi;
constexpr double exact_px = 1e-3, sought_px = 1e-7;

/// 0 <= angle < 2 pi
double wrapped(double angle) {
    const double a = std::fmod(angle, 2 * pi);
    const double positive = a < 0 ? a + 2 * pi : a;
    return positive < 2 * pi ? positive : 0;
}

glm::dvec3 level_direction(const glm::dmat3& enu, double heading) {
    return std::sin(heading) * enu[0] + std::cos(heading) * enu[1];
}

double heading_of(const glm::dmat3& enu, const glm::dvec3& direction) {
    return wrapped(std::atan2(glm::dot(direction, enu[0]), glm::dot(direction, enu[1])));
}

struct Axes {
    glm::dvec3 right, up, ahead;
};

Axes axes_of(const Pose& pose) {
    const glm::dmat3 enu = planet::ecef_from_enu(pose.normal);
    const glm::dvec3 level = level_direction(enu, pose.heading);
    const double c = std::cos(pose.pitch), s = std::sin(pose.pitch);
    return {glm::cross(level, enu[2]), c * enu[2] - s * level, c * level + s * enu[2]};
}

glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return c * v + s * glm::cross(axis, v) + (1 - c) * glm::dot(axis, v) * axis;
}

std::optional<glm::dvec2> shown(const Pose& pose, const Lens& lens, const glm::dvec3& direction) {
    const Axes axes = axes_of(pose);
    const double depth = glm::dot(direction, axes.ahead);
    if (!(depth > 1e-6 * glm::length(direction))) return std::nullopt;
    return lens.middle() +
           lens.focal / depth * glm::dvec2(glm::dot(direction, axes.right), -glm::dot(direction, axes.up));
}

/// On this side of the horizon of a ball through it: not through the planet.
bool faces(const Pose& pose, const glm::dvec3& point) {
    return glm::dot(pose.eye() - point, point) > 0 || glm::length(point) > glm::length(pose.eye());
}

/// Newton's method on two unknowns with steps that never carry the point farther than `stride_px` over the picture and
/// that are halved until they help.
template <class Place, class Change>
Held search(const Pose& start, const glm::dvec2& pixel, double unit, double largest, Place&& place, Change&& change) {
    constexpr int most_steps = 200;
    constexpr double stride_px = 100, fraction = 1e-4;
    Pose pose = start;
    auto at = place(pose);
    if (!at) return {start, false};
    for (int i = 0; i < most_steps && glm::distance(*at, pixel) > sought_px; ++i) {
        const double d = fraction * unit;
        const auto e1 = place(change(pose, d, 0)), e0 = place(change(pose, -d, 0)), n1 = place(change(pose, 0, d)),
                   n0 = place(change(pose, 0, -d));
        if (!e1 || !e0 || !n1 || !n0) break;
        const glm::dmat2 jacobian((*e1 - *e0) / (2 * d), (*n1 - *n0) / (2 * d));
        glm::dvec2 way = pixel - *at;
        if (const double length = glm::length(way); length > stride_px) way *= stride_px / length;
        // Damped: where a direction does not move the point any more, as on the limb, it is not taken.
        const glm::dmat2 transposed = glm::transpose(jacobian);
        glm::dmat2 square = transposed * jacobian;
        const double damping = 1e-12 * (square[0][0] + square[1][1]);
        square[0][0] += damping;
        square[1][1] += damping;
        if (!(std::abs(glm::determinant(square)) > 0)) break;
        glm::dvec2 step = glm::inverse(square) * (transposed * way);
        if (const double length = glm::length(step); length > largest) step *= largest / length;
        const double before = glm::distance(*at, pixel);
        bool better = false;
        for (int halving = 0; halving < 12 && !better; ++halving, step *= 0.5) {
            const Pose next = change(pose, step.x, step.y);
            const auto there = place(next);
            if (!there || !(glm::distance(*there, pixel) < before)) continue;
            pose = next;
            at = there;
            better = true;
        }
        if (!better) break;
    }
    return {pose, glm::distance(*at, pixel) < exact_px};
}

double farthest_step(const Pose& pose, const glm::dvec3& point) {
    return std::min(glm::distance(pose.eye(), point), 0.2 * wgs84.a);
}

Held hold_once(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, Compass compass) {
    const double reach = farthest_step(pose, point);
    const auto place = [&](const Pose& p) { return faces(p, point) ? pixel_of_point(p, lens, point) : std::nullopt; };
    return search(pose, pixel, reach, reach, place,
                  [&](const Pose& p, double east, double north) { return moved(p, east, north, compass); });
}

}  // namespace

Camera Lens::camera(const Pose& pose) const {
    return make_camera(pose.eye(), pose.normal, pose.heading, pose.pitch, focal, width, height);
}

glm::dvec3 ray(const Pose& pose, const Lens& lens, const glm::dvec2& pixel) {
    const Axes axes = axes_of(pose);
    const glm::dvec2 off = (pixel - lens.middle()) / lens.focal;
    return glm::normalize(axes.ahead + off.x * axes.right - off.y * axes.up);
}

std::optional<glm::dvec2> pixel_of_direction(const Pose& pose, const Lens& lens, const glm::dvec3& direction) {
    return shown(pose, lens, direction);
}

std::optional<glm::dvec2> pixel_of_point(const Pose& pose, const Lens& lens, const glm::dvec3& point) {
    return shown(pose, lens, point - pose.eye());
}

Pose moved(const Pose& pose, double east_m, double north_m, Compass compass) {
    const double arc = std::hypot(east_m, north_m);
    if (arc == 0) return pose;
    const glm::dmat3 enu = planet::ecef_from_enu(pose.normal);
    const glm::dvec3 way = (east_m * enu[0] + north_m * enu[1]) / arc;
    const glm::dvec3 axis = glm::cross(pose.normal, way);
    // Metres below a high eye are of the ground, not of the circle the eye goes round on.
    const double angle = arc / wgs84.mean_radius();
    Pose to = pose;
    to.normal = glm::normalize(rotated(pose.normal, axis, angle));
    if (compass == Compass::carried)
        to.heading =
            heading_of(planet::ecef_from_enu(to.normal), rotated(level_direction(enu, pose.heading), axis, angle));
    return to;
}

Pose pose_from(const glm::dvec3& eye, const glm::dvec3& ahead, const glm::dvec3& up) {
    const planet::NormalPosition at = planet::position_from_ecef(wgs84, eye);
    const glm::dmat3 enu = planet::ecef_from_enu(at.normal);
    const double rise = std::clamp(glm::dot(ahead, at.normal), -1.0, 1.0);
    const glm::dvec3 level = ahead - rise * at.normal;
    const double pitch = std::atan2(rise, glm::length(level));
    // Straight down, what is up in the picture is where it heads; straight up, what is down.
    const bool vertical = glm::length(level) < 1e-6;
    return {at.normal, at.h.m, heading_of(enu, vertical ? (rise < 0 ? up : -up) : level), pitch};
}

Held hold(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, Compass compass) {
    const Held held = hold_once(pose, lens, point, pixel, compass);
    if (held.exact || compass == Compass::carried) return held;
    const Held carried = hold_once(pose, lens, point, pixel, Compass::carried);
    return carried.exact ? carried : held;
}

Held turn_to(const Pose& pose, const Lens& lens, const glm::dvec3& direction, const glm::dvec2& pixel) {
    return search(
        pose, pixel, 1, 0.3, [&](const Pose& p) { return pixel_of_direction(p, lens, direction); },
        [](Pose p, double turn, double tilt) {
            p.heading = wrapped(p.heading + turn);
            p.pitch = std::clamp(p.pitch + tilt, -0.5 * pi, 0.5 * pi);
            return p;
        });
}

double highest_pitch(double h) {
    constexpr double free_below_m = 5e4, held_above_m = 5e5;
    // From straight down nearly to the limb.
    const double planet_angle = 0.9 * std::asin(wgs84.b / (wgs84.b + std::max(h, 0.0)));
    const double t =
        std::clamp(std::log(std::max(h, 1.0) / free_below_m) / std::log(held_above_m / free_below_m), 0.0, 1.0);
    const double from_down = std::lerp(179 * planet::degrees, planet_angle, t * t * (3 - 2 * t));
    return from_down - 0.5 * pi;
}

Pose zoomed(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, double factor,
            Compass compass) {
    const planet::NormalPosition at = planet::position_from_ecef(wgs84, point + factor * (pose.eye() - point));
    if (at.h.m > highest_eye_m) return pose;
    Pose to = moved(pose, 0, 0, compass);
    const glm::dmat3 enu = planet::ecef_from_enu(pose.normal);
    const double cosine = glm::dot(at.normal, pose.normal);
    const glm::dvec3 way = at.normal - cosine * pose.normal;
    if (const double sine = glm::length(way); sine > 0) {
        const double arc = std::atan2(sine, cosine) * wgs84.mean_radius() / sine;
        to = moved(pose, arc * glm::dot(way, enu[0]), arc * glm::dot(way, enu[1]), compass);
    }
    to.h = at.h.m;
    if (factor > 1) to.pitch = std::min(to.pitch, highest_pitch(to.h));
    // The ground is in its pixel again by a step aside; a peak that is level with the eye by a turn of the head.
    const double rise = glm::dot(glm::normalize(point - to.eye()), to.normal);
    const bool level = rise > -0.05;
    const Held held = hold(to, lens, point, pixel, compass);
    if (!level && (held.exact || factor > 1)) return held.pose;
    const Held turned = turn_to(to, lens, point - to.eye(), pixel);
    return turned.exact || level ? turned.pose : held.pose;
}

Pose orbited(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, double turn,
             double tilt) {
    const double up_to = std::min(std::max(highest_pitch(pose.h), pose.pitch), 89 * planet::degrees);
    const double bounded = std::clamp(pose.pitch + tilt, -0.5 * pi, up_to) - pose.pitch;
    const Axes axes = axes_of(pose);
    const glm::dvec3 pole = planet::normal_from_ecef(wgs84, point), back = pose.eye() - point;
    const auto rotate = [&](const glm::dvec3& v) { return rotated(rotated(v, axes.right, bounded), pole, -turn); };
    Pose to = pose_from(point + rotate(back), rotate(axes.ahead), rotate(axes.up));
    if (pose.pitch > -60 * planet::degrees) {
        to.pitch = std::min(to.pitch, 89 * planet::degrees);
        const Held held = turn_to(to, lens, point - to.eye(), pixel);
        if (held.exact) return held.pose;
    }
    // Near straight down, the least tilt aside would become any heading: the angles are set, and the eye follows.
    to.heading = wrapped(pose.heading + turn);
    to.pitch = pose.pitch + bounded;
    for (int i = 0; i < 3; ++i) {
        to = hold(to, lens, point, pixel, Compass::kept).pose;
        const double ratio = glm::length(back) / glm::distance(to.eye(), point);
        if (std::abs(ratio - 1) < 1e-9) break;
        to.h = planet::height_from_ecef(wgs84, point + ratio * (to.eye() - point)).m;
    }
    return hold(to, lens, point, pixel, Compass::kept).pose;
}

Pose lifted(Pose pose, double floor_h) {
    pose.h = std::max(pose.h, floor_h);
    return pose;
}

void Glide::note(const Pose& from, const Pose& to, double seconds) {
    const glm::dmat3 enu = planet::ecef_from_enu(from.normal);
    const glm::dvec3 way = (to.normal - from.normal) * wgs84.mean_radius();
    const double dt = std::max(seconds, 1e-4), weight = 1 - std::exp(-dt / 0.1);
    velocity_ = glm::mix(velocity_, glm::dvec2(glm::dot(way, enu[0]), glm::dot(way, enu[1])) / dt, weight);
}

Pose Glide::advance(const Pose& pose, const Lens& lens, double clearance_m, double seconds, Compass compass) {
    constexpr double slowing_s = 0.35;
    const double pixel_m = std::max(clearance_m, 1.0) / lens.focal;
    if (glm::length(velocity_) * 0.1 < pixel_m) {
        stop();
        return pose;
    }
    const glm::dvec2 way = velocity_ * slowing_s * (1 - std::exp(-seconds / slowing_s));
    const Pose to = moved(pose, way.x, way.y, compass);
    velocity_ *= std::exp(-seconds / slowing_s);
    return to;
}

}  // namespace render
