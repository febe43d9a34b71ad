// Flights for film: they pass their keys, never jump, and never touch the ground.

#include "render/viewer/flight_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "planet/geodesy/geodetic.h"
#include "render/viewer/flight_clearance.h"

namespace render {
namespace {

using planet::degrees;
using planet::wgs84;

FlightKey key(double latitude, double longitude, double range, double heading = 0, double pitch = -60) {
    FlightKey k;
    k.view.sight = {planet::normal_from_geodetic(latitude * degrees, longitude * degrees), 0, range, heading * degrees,
                    pitch * degrees};
    return k;
}

FlightKey at_time(FlightKey k, double seconds) {
    k.seconds = seconds;
    return k;
}

void expect_same(const Sight& a, const Sight& b) {
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.h, b.h);
    EXPECT_EQ(a.range, b.range);
    EXPECT_EQ(a.heading, b.heading);
    EXPECT_EQ(a.pitch, b.pitch);
}

struct Look {
    glm::dvec3 eye, ahead;
    double range;
};

Look look_at(const FlightPath& path, double seconds) {
    const Sight s = path.at(seconds).sight;
    return {eye_of(s, path.about()), look_direction(s.normal, s.heading, s.pitch), s.range};
}

/// The largest jump between two moments, of the eye in ranges and of the view in radians; and of their velocities.
struct Jumps {
    double step = 0, kink = 0;
};
Jumps jumps_of(const FlightPath& path, double dt) {
    Jumps jumps;
    Look a = look_at(path, 0), b = look_at(path, dt);
    for (double t = 2 * dt; t <= path.duration(); t += dt) {
        const Look c = look_at(path, t);
        const double step = glm::distance(c.eye, b.eye) / b.range + glm::distance(c.ahead, b.ahead);
        const double kink =
            glm::length(c.eye - 2.0 * b.eye + a.eye) / b.range + glm::length(c.ahead - 2.0 * b.ahead + a.ahead);
        jumps = {std::max(jumps.step, step), std::max(jumps.kink, kink)};
        a = b;
        b = c;
    }
    return jumps;
}

/// A kink of velocity stays as large a part of a step when steps get shorter; a bend does not.
void expect_smooth(const FlightPath& path) {
    const Jumps coarse = jumps_of(path, 1 / 60.0), fine = jumps_of(path, 1 / 480.0);
    EXPECT_LT(coarse.step, 0.1);
    EXPECT_LT(fine.kink, 0.35 * coarse.kink / 8 + 1e-6);
    EXPECT_LT(fine.step, 1.2 * coarse.step / 8);
}

TEST(FlightPath, PassesItsKeysAtTheirTimes) {
    const std::vector<FlightKey> keys{key(10, 20, 1e7), at_time(key(12, 30, 1e5, 90), 4), key(12, 30.5, 1e5, 120),
                                      at_time(key(-40, 170, 2e4, 350, -10), 15), key(-40, 170, 2e4, 10, -10)};
    const FlightPath path(keys, About::place);
    ASSERT_EQ(path.times().size(), keys.size());
    EXPECT_EQ(path.times()[1], 4);
    EXPECT_EQ(path.times()[3], 15);
    for (std::size_t i = 0; i < keys.size(); ++i) expect_same(path.at(path.times()[i]).sight, keys[i].view.sight);
    expect_same(path.at(-1).sight, keys.front().view.sight);
    expect_same(path.at(1e9).sight, keys.back().view.sight);
}

TEST(FlightPath, IsSmooth) {
    expect_smooth({{key(37, -105, 1e7), key(37.5, -105.5, 4e4, 30, -25), key(37.6, -105.4, 1.5e4, 80, -15),
                    key(37.9, -105.3, 3e4, 170, -30)},
                   About::place});
    // Over the pole, over the antimeridian, and far away and back.
    expect_smooth({{key(80, 0, 3e5, 0), key(84, 180, 3e5, 180), key(70, 179, 4e5, 90), key(70, -179, 4e5, 90),
                    key(-30, -60, 2e5), key(-30, -59, 2e5, 90)},
                   About::place});
    expect_smooth({{key(46, 7, 800, 20, -5), key(46.02, 7.01, 1200, 40, -8), key(46.03, 7.05, 500, 120, 0),
                    key(46.03, 7.05, 500, 120, 0), key(46, 7.1, 900, 200, -5)},
                   About::eye});
}

TEST(FlightPath, HeadingTakesTheShorterWay) {
    const FlightPath path({key(0, 0, 1e5, 350), key(0, 0.1, 1e5, 10)}, About::place);
    const double middle = path.at(path.duration() / 2).sight.heading / degrees;
    EXPECT_TRUE(middle < 5 || middle > 355) << middle;
}

TEST(FlightPath, StraightOverThePoleTheViewDoesNotTurn) {
    const FlightPath path({key(85, 20, 2e5, 0, -30), key(85, -160, 2e5, 180, -30)}, About::place);
    const Look first = look_at(path, 0);
    // The great circle's plane holds every direction of the view.
    const glm::dvec3 across = glm::normalize(glm::cross(first.eye, first.ahead));
    for (double t = 0; t < path.duration(); t += path.duration() / 100)
        EXPECT_NEAR(glm::dot(look_at(path, t).ahead, across), 0, 1e-3) << t;
}

TEST(FlightPath, RangeStaysBetweenNearKeysAndGoesOutBetweenFarOnes) {
    const FlightPath near({key(37, -105, 4e4), key(37.3, -105, 1e4), key(37.4, -105, 1e4), key(37.6, -105, 3e4)},
                          About::place);
    for (double t = 0; t < near.duration(); t += 0.01) {
        EXPECT_GT(near.at(t).sight.range, 0.99e4);
        EXPECT_LT(near.at(t).sight.range, 4.05e4);
    }
    const FlightPath far({key(37, -105, 1e4, 0, -20), key(46, 7, 1e4, 0, -20)}, About::place);
    const Sight middle = far.at(far.duration() / 2).sight;
    EXPECT_GT(middle.range, 2e6);
    EXPECT_LT(middle.pitch, -80 * degrees);
}

TEST(FlightPath, BeginsAndEndsAtRestAndRestsWhereTwoKeysAreTheSame) {
    const FlightPath path({at_time(key(0, 0, 1e5), 0), at_time(key(1, 0, 1e5), 3), at_time(key(1, 0, 1e5), 5),
                           at_time(key(1, 1, 1e5), 8)},
                          About::place);
    const auto moved = [&](double t) { return glm::distance(look_at(path, t).eye, look_at(path, t + 0.01).eye); };
    EXPECT_LT(moved(0), 20);
    EXPECT_LT(moved(7.99), 20);
    EXPECT_GT(moved(1.5), 100);
    for (double t = 3; t < 4.95; t += 0.1) EXPECT_LT(moved(t), 1) << t;
}

TEST(FlightPath, ExaggerationAndSunFollow) {
    FlightKey from = key(0, 0, 1e5), to = key(0, 0, 1e5);
    to.view.exaggeration = 3;
    to.view.time = from.view.time + std::chrono::hours(2);
    const FlightPath path({from, to}, About::place);
    const FlightView middle = path.at(path.duration() / 2);
    EXPECT_NEAR(middle.exaggeration, 2, 1e-9);
    EXPECT_EQ(middle.time, from.view.time + std::chrono::hours(1));
    EXPECT_GT(path.duration(), 1);
}

TEST(FlightClearance, LiftsTheEyeOverARidgeAndLeavesTheRestAlone) {
    // A wall of 1 km at half a degree east.
    const auto ground = [](const glm::dvec3& normal, double exaggeration) {
        const double longitude = planet::geodetic_from_normal(normal).longitude / degrees;
        return exaggeration * 1000 * std::exp(-std::pow((longitude - 0.5) / 0.02, 2));
    };
    const FlightPath path({at_time(key(0, 0, 200, 90, 0), 0), at_time(key(0, 1, 200, 90, 0), 40)}, About::eye);
    const FlightClearance clearance(path, ground);
    EXPECT_EQ(clearance.lift(0), 0);
    EXPECT_EQ(clearance.lift(40), 0);
    double last = 0, last_change = 0;
    for (double t = 0; t <= 40; t += 0.02) {
        const FlightView view = path.at(t);
        const double lift = clearance.lift(t), h = view.sight.h + view.sight.range + lift;
        EXPECT_GT(h, ground(view.sight.normal, 1) + 15) << t;
        EXPECT_LT(std::abs(lift - last - last_change), 4) << t;
        last_change = lift - last;
        last = lift;
    }
}

}  // namespace
}  // namespace render
