#include "render/viewer/flight_clearance.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geodetic.h"

namespace render {

namespace {

constexpr double wanted_m = 30;
constexpr double spread_s = 1;
constexpr double finest_step_s = 0.05;
constexpr std::size_t most_steps = 200'000;
constexpr double highest_ground_m = 9000;

/// Of the eye over the ground, m.
double clearance(const FlightView& view, About about, const FlightClearance::GroundHeight& ground) {
    const planet::NormalPosition eye = planet::position_from_ecef(planet::wgs84, eye_of(view.sight, about));
    // No ground is asked for that no eye can touch.
    if (eye.h.m > highest_ground_m * std::max(view.exaggeration, 1.0)) return eye.h.m;
    return eye.h.m - ground(eye.normal, view.exaggeration);
}

/// The largest in 2 `reach` + 1 values about each.
std::vector<double> widened(const std::vector<double>& values, std::ptrdiff_t reach) {
    const auto count = std::ptrdiff_t(values.size());
    std::vector<double> wide(values.size(), 0);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        if (values[std::size_t(i)] <= 0) continue;
        for (std::ptrdiff_t k = std::max(i - reach, std::ptrdiff_t(0)); k <= std::min(i + reach, count - 1); ++k)
            wide[std::size_t(k)] = std::max(wide[std::size_t(k)], values[std::size_t(i)]);
    }
    return wide;
}

/// The mean of 2 `reach` + 1 values about each; beyond the ends these go on.
std::vector<double> averaged(const std::vector<double>& values, std::ptrdiff_t reach) {
    const auto count = std::ptrdiff_t(values.size());
    const auto value = [&](std::ptrdiff_t i) {
        return values[std::size_t(std::clamp(i, std::ptrdiff_t(0), count - 1))];
    };
    std::vector<double> mean(values.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        double sum = 0;
        for (std::ptrdiff_t k = i - reach; k <= i + reach; ++k) sum += value(k);
        mean[std::size_t(i)] = sum / double(2 * reach + 1);
    }
    return mean;
}

}  // namespace

FlightClearance::FlightClearance(const FlightPath& path, const GroundHeight& ground) {
    std::vector<double> at_keys;
    for (const double seconds : path.times())
        at_keys.push_back(std::clamp(clearance(path.at(seconds), path.about(), ground), least_clearance_m, wanted_m));
    const MonotoneCubic wanted(path.times(), at_keys, MonotoneCubic::Ends::free);
    const double steps = std::min(std::ceil(path.duration() / finest_step_s), double(most_steps));
    step_s_ = path.duration() / steps;
    for (double i = 0; i <= steps; ++i) {
        const double seconds = i * step_s_;
        lifts_.push_back(std::max(wanted.at(seconds) - clearance(path.at(seconds), path.about(), ground), 0.0));
    }
    // What is widened first may be averaged over as much and is nowhere lower than it was.
    const auto reach = std::ptrdiff_t(std::ceil(0.5 * spread_s / step_s_));
    lifts_ = averaged(averaged(widened(lifts_, 2 * reach), reach), reach);
}

double FlightClearance::lift(double seconds) const {
    const double place = std::clamp(seconds / step_s_, 0.0, double(lifts_.size() - 1));
    const auto i = std::min(std::size_t(place), lifts_.size() - 1), next = std::min(i + 1, lifts_.size() - 1);
    return std::lerp(lifts_[i], lifts_[next], place - double(i));
}

}  // namespace render
