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

glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double t) {
    const double angle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    if (angle < 1e-12) return b;
    // Opposite places: any great circle will do.
    glm::dvec3 across = b - glm::dot(a, b) * a;
    if (glm::length(across) < 1e-9)
        across = glm::cross(a, std::abs(a.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0));
    return std::cos(t * angle) * a + std::sin(t * angle) * glm::normalize(across);
}

}  // namespace

Pose pose_of(const Sight& s) {
    const glm::dvec3 ahead = look_direction(s.normal, s.heading, s.pitch),
                     up = look_direction(s.normal, s.heading, s.pitch + 0.5 * std::numbers::pi);
    return pose_from(planet::ecef_from_normal(wgs84, s.normal, {s.h}) - s.range * ahead, ahead, up);
}

Flight::Flight(const Sight& from, const Sight& to) : from_(from), to_(to) {
    ground_m_ = wgs84.mean_radius() *
                std::atan2(glm::length(glm::cross(from.normal, to.normal)), glm::dot(from.normal, to.normal));
    const double u = ground_m_, w0 = from.range, w1 = to.range;
    if (u < 1e-6 * std::min(w0, w1)) {
        length_ = std::abs(std::log(w1 / w0)) / rho;
    } else {
        const double r2 = rho * rho, r4u2 = r2 * r2 * u * u;
        const double b0 = (w1 * w1 - w0 * w0 + r4u2) / (2 * w0 * r2 * u),
                     b1 = (w1 * w1 - w0 * w0 - r4u2) / (2 * w1 * r2 * u);
        r0_ = -std::asinh(b0);
        length_ = (-std::asinh(b1) - r0_) / rho;
    }
    const double turn =
        std::abs(std::remainder(to.heading - from.heading, 2 * std::numbers::pi)) + std::abs(to.pitch - from.pitch);
    duration_ = std::clamp(std::max(length_ / speed, turn / 1.5), 0.3, 8.0);
}

Sight Flight::at(double seconds) const {
    const double linear = duration_ > 0 ? std::clamp(seconds / duration_, 0.0, 1.0) : 1;
    if (linear >= 1) return to_;
    const double t = linear * linear * linear * (linear * (6 * linear - 15) + 10), s = t * length_;
    Sight sight = to_;
    double part = t;
    if (ground_m_ < 1e-6 * std::min(from_.range, to_.range)) {
        sight.range = from_.range * std::pow(to_.range / from_.range, t);
    } else {
        const double w0 = from_.range;
        sight.range = w0 * std::cosh(r0_) / std::cosh(rho * s + r0_);
        const double u = w0 / (rho * rho) * (std::cosh(r0_) * std::tanh(rho * s + r0_) - std::sinh(r0_));
        part = std::clamp(u / ground_m_, 0.0, 1.0);
    }
    sight.normal = between(from_.normal, to_.normal, part);
    sight.h = std::lerp(from_.h, to_.h, part);
    sight.heading = turned(from_.heading, to_.heading, t);
    // An eye that looks up must look down before it goes back, or it would go back into the ground.
    const bool looks_up = from_.pitch > -5 * planet::degrees;
    sight.pitch = std::lerp(from_.pitch, to_.pitch, looks_up ? 1 - std::pow(1 - t, 40) : t);
    return sight;
}

}  // namespace render
