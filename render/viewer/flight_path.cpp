#include "render/viewer/flight_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "planet/geodesy/local_frame.h"

namespace render {

namespace {

using planet::degrees;
using planet::wgs84;

constexpr double pi = std::numbers::pi;

// A quiet pace: half of the viewer's, which has a hand that waits.
constexpr double flow_per_s = 0.7;           // in the measure of ZoomPan
constexpr double turn_per_s = 25 * degrees;  // of heading and pitch together
constexpr double exaggeration_per_s = 1;     // a factor of e
constexpr double sun_per_s = 3600;           // seconds of the sun's
constexpr double least_leg_s = 1e-3;         // equal views are a rest, which lasts as long as their times say
constexpr double bend_s = 1.5;               // beside a key, in which the way takes a common velocity
constexpr double polar = 75 * degrees;       // beyond this latitude north is no direction to hold on to

constexpr double largest_rho = std::numbers::sqrt2, least_rho = 0.15;

/// A near place is no reason to go out: what is between is in view anyway.
double rho_of(double ground_m, double from_m, double to_m) {
    constexpr double near = 8, far = 50;  // ranges
    const double ranges = ground_m / std::sqrt(from_m * to_m);
    const double t = std::clamp(std::log(std::max(ranges, near) / near) / std::log(far / near), 0.0, 1.0);
    return std::max(largest_rho * std::sqrt(t * t * (3 - 2 * t)), least_rho);
}

/// How much the picture flows on a way, in the paper's measure for its own rho.
double flow_of(const ZoomPan& way, double ground_m) {
    constexpr int pieces = 64;
    double sum = 0;
    for (int i = 0; i < pieces; ++i) {
        const ZoomPan::State state = way.at((i + 0.5) / pieces * way.length());
        sum += std::hypot(largest_rho * ground_m * state.part_rate / state.range, state.log_range_rate / largest_rho);
    }
    return sum * way.length() / pieces;
}

double course(const glm::dvec3& normal, const glm::dvec3& ahead) {
    const glm::dmat3 enu = planet::ecef_from_enu(normal);
    return std::atan2(glm::dot(ahead, enu[0]), glm::dot(ahead, enu[1]));
}

double shorter_turn(double from, double to) {
    return std::remainder(to - from, 2 * pi);
}

/// Bends a way by its velocity at one end, and is gone with its slope after the length of 1. At most 0.106.
double bend(double x) {
    return x < 1 ? x * (1 - x) * (1 - x) * (1 - x) : 0;
}

double bent_s(double leg_length) {
    return std::min(bend_s, 0.5 * leg_length);
}

}  // namespace

glm::dvec3 eye_of(const Sight& s, About about) {
    if (about == About::eye) return planet::ecef_from_normal(wgs84, s.normal, {s.h + s.range});
    return planet::ecef_from_normal(wgs84, s.normal, {s.h}) - s.range * look_direction(s.normal, s.heading, s.pitch);
}

FlightPath::FlightPath(std::vector<FlightKey> keys, About about) : keys_(std::move(keys)), about_(about) {
    assert(keys_.size() >= 2);
    double begin = 0, carried = 0;
    for (std::size_t i = 0; i + 1 < keys_.size(); ++i) {
        Leg leg = make_leg(i);
        leg.begin = begin;
        leg.carried_before = carried;
        begin += leg.length;
        carried += leg.carried;
        legs_.push_back(std::move(leg));
    }
    set_times();
    agree_velocities();
    set_curves();
}

FlightPath::Leg FlightPath::make_leg(std::size_t i) const {
    const FlightView &from = keys_[i].view, &to = keys_[i + 1].view;
    Leg leg;
    leg.ground = GreatCircle(from.sight.normal, to.sight.normal);
    const double ground_m = leg.ground.angle() * wgs84.mean_radius();
    leg.way = ZoomPan(ground_m, from.sight.range, to.sight.range, rho_of(ground_m, from.sight.range, to.sight.range));
    // The middle of a great circle or one of its ends is nearest to a pole, or it turns little.
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
        leg.polar = leg.polar || (ground_m > 0 && std::abs(leg.ground.at(t).z) > std::sin(polar));
    if (leg.polar)
        leg.carried =
            shorter_turn(course(from.sight.normal, leg.ground.ahead(0)), course(to.sight.normal, leg.ground.ahead(1)));
    const double turn =
        std::hypot(shorter_turn(from.sight.heading + leg.carried, to.sight.heading), to.sight.pitch - from.sight.pitch);
    const double sun_s = std::abs(std::chrono::duration<double>(to.time - from.time).count());
    const double steeper = std::abs(std::log((to.exaggeration + 0.1) / (from.exaggeration + 0.1)));
    leg.length = std::max({flow_of(leg.way, ground_m) / flow_per_s, turn / turn_per_s, sun_s / sun_per_s,
                           steeper / exaggeration_per_s, least_leg_s});
    leg.at_begin = velocity(leg, i, 0);
    leg.at_end = velocity(leg, i, leg.way.length());
    return leg;
}

FlightPath::Velocity FlightPath::velocity(const Leg& leg, std::size_t i, double s) const {
    const ZoomPan::State state = leg.way.at(s);
    const double per_s = leg.way.length() / leg.length;
    const double climb_m = keys_[i + 1].view.sight.h - keys_[i].view.sight.h,
                 ground_m = leg.ground.angle() * wgs84.mean_radius();
    const glm::dvec3 way = ground_m * leg.ground.ahead(state.part) + climb_m * leg.ground.at(state.part);
    return {way * (state.part_rate * per_s / state.range), leg.way.length() > 0 ? state.log_range_rate * per_s : 0};
}

// Between two keys with times, those without share the time as their paces ask.
void FlightPath::set_times() {
    std::vector<double> paced{0};
    for (std::size_t i = 0; i < legs_.size(); ++i) paced.push_back(paced.back() + legs_[i].length / keys_[i + 1].pace);
    times_.assign(keys_.size(), 0);
    std::size_t known = 0;
    const auto fill = [&](std::size_t end, double stretch) {
        for (std::size_t k = known + 1; k < end; ++k) times_[k] = times_[known] + stretch * (paced[k] - paced[known]);
    };
    for (std::size_t i = 1; i < keys_.size(); ++i) {
        if (!keys_[i].seconds) continue;
        times_[i] = *keys_[i].seconds - keys_.front().seconds.value_or(0);
        assert(times_[i] > times_[known]);
        fill(i, (times_[i] - times_[known]) / (paced[i] - paced[known]));
        known = i;
    }
    fill(keys_.size(), 1);
}

void FlightPath::agree_velocities() {
    legs_.front().wanted_begin = legs_.front().at_begin;
    legs_.back().wanted_end = legs_.back().at_end;
    for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
        const Velocity &before = legs_[i].at_end, &after = legs_[i + 1].at_begin;
        const double least = std::min(glm::length(before.place), glm::length(after.place));
        glm::dvec3 place = 0.5 * (before.place + after.place);
        if (const double length = glm::length(place); length > 2 * least) place *= 2 * least / length;  // a rest
        legs_[i].wanted_end = legs_[i + 1].wanted_begin = {
            place, monotone_slope(before.log_range, after.log_range, legs_[i].length, legs_[i + 1].length)};
    }
}

void FlightPath::set_curves() {
    std::vector<double> way, heading, pitch, exaggeration, sun;
    double turned = keys_.front().view.sight.heading;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
        const FlightView& view = keys_[i].view;
        if (i > 0) turned += shorter_turn(keys_[i - 1].view.sight.heading + legs_[i - 1].carried, view.sight.heading);
        way.push_back(i < legs_.size() ? legs_[i].begin : legs_.back().begin + legs_.back().length);
        heading.push_back(turned);
        pitch.push_back(view.sight.pitch);
        exaggeration.push_back(view.exaggeration);
        sun.push_back(std::chrono::duration<double>(view.time - keys_.front().view.time).count());
    }
    way_of_time_ = MonotoneCubic(times_, way, MonotoneCubic::Ends::at_rest);
    heading_ = MonotoneCubic(way, heading, MonotoneCubic::Ends::free);
    pitch_ = MonotoneCubic(way, pitch, MonotoneCubic::Ends::free);
    exaggeration_ = MonotoneCubic(way, exaggeration, MonotoneCubic::Ends::free);
    sun_ = MonotoneCubic(way, sun, MonotoneCubic::Ends::free);
}

Sight FlightPath::sight_on(std::size_t i, double s) const {
    const Leg& leg = legs_[i];
    const Sight &from = keys_[i].view.sight, &to = keys_[i + 1].view.sight;
    const double since = s - leg.begin, left = leg.length - since, x = since / leg.length, d = bent_s(leg.length);
    const ZoomPan::State state = leg.way.at(x * leg.way.length());
    const double in = d * bend(since / d), out = -d * bend(left / d);
    const double log_bend = in * (leg.wanted_begin.log_range - leg.at_begin.log_range) +
                            out * (leg.wanted_end.log_range - leg.at_end.log_range);
    const glm::dvec3 offset = state.range * (in * (leg.wanted_begin.place - leg.at_begin.place) +
                                             out * (leg.wanted_end.place - leg.at_end.place));
    const glm::dvec3 normal = leg.ground.at(state.part);
    const double up = glm::dot(offset, normal);
    Sight sight;
    sight.normal = glm::normalize(normal + (offset - up * normal) / wgs84.mean_radius());
    sight.h = std::lerp(from.h, to.h, state.part) + up;
    sight.range = state.range * std::exp(log_bend);
    const double carried =
        leg.polar ? shorter_turn(course(from.normal, leg.ground.ahead(0)), course(normal, leg.ground.ahead(state.part)))
                  : 0;
    const double heading = std::fmod(heading_.at(s) + leg.carried_before + carried, 2 * pi);
    sight.heading = heading < 0 ? heading + 2 * pi : heading;
    // Far out between two near views the planet is below, and not where they look.
    const double beyond = std::max(std::log(state.range / from.range) - x * std::log(to.range / from.range), 0.0);
    sight.pitch = -0.5 * pi + (pitch_.at(s) + 0.5 * pi) / (1 + 0.5 * beyond * beyond);
    return sight;
}

FlightView FlightPath::at(double seconds) const {
    const double s = way_of_time_.at(seconds);
    const auto after =
        std::upper_bound(legs_.begin(), legs_.end(), s, [](double value, const Leg& leg) { return value < leg.begin; });
    const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - legs_.begin() - 1, 0));
    if (s <= legs_[i].begin) return keys_[i].view;
    if (s >= legs_[i].begin + legs_[i].length) return keys_[i + 1].view;
    const std::chrono::duration<double> sun(sun_.at(s));
    return {sight_on(i, s), exaggeration_.at(s),
            keys_.front().view.time + std::chrono::round<std::chrono::milliseconds>(sun)};
}

}  // namespace render
