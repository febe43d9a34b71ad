#include "render/viewer/flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render {

namespace {

using planet::wgs84;

/// How much a path prefers zooming to panning; the paper's users liked sqrt 2.
constexpr double rho = std::numbers::sqrt2;
/// Lengths of that path a second.
constexpr double speed = 1.6;

/// The shorter way around.
double turned(double from, double to, double t) {
    return from + t * std::remainder(to - from, 2 * std::numbers::pi);
}

}  // namespace

Pose pose_of(const Sight& s) {
    const glm::dvec3 ahead = look_direction(s.normal, s.heading, s.pitch),
                     up = look_direction(s.normal, s.heading, s.pitch + 0.5 * std::numbers::pi);
    return pose_from(planet::ecef_from_normal(wgs84, s.normal, {s.h}) - s.range * ahead, ahead, up);
}

Flight::Flight(const Sight& from, const Sight& to)
    : from_(from),
      to_(to),
      ground_(from.normal, to.normal),
      way_(ground_.angle() * wgs84.mean_radius(), from.range, to.range, rho) {
    const double turn =
        std::abs(std::remainder(to.heading - from.heading, 2 * std::numbers::pi)) + std::abs(to.pitch - from.pitch);
    duration_ = std::clamp(std::max(way_.length() / speed, turn / 1.5), 0.3, 8.0);
}

Sight Flight::at(double seconds) const {
    const double linear = duration_ > 0 ? std::clamp(seconds / duration_, 0.0, 1.0) : 1;
    if (linear >= 1) return to_;
    const double t = linear * linear * linear * (linear * (6 * linear - 15) + 10);
    const ZoomPan::State state = way_.at(t * way_.length());
    Sight sight = to_;
    sight.range = state.range;
    const double part = state.part;
    sight.normal = ground_.at(part);
    sight.h = std::lerp(from_.h, to_.h, part);
    sight.heading = turned(from_.heading, to_.heading, t);
    // An eye that looks up must look down before it goes back, or it would go back into the ground.
    const bool looks_up = from_.pitch > -5 * planet::degrees;
    sight.pitch = std::lerp(from_.pitch, to_.pitch, looks_up ? 1 - std::pow(1 - t, 40) : t);
    return sight;
}

}  // namespace render
