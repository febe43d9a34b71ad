// Hands on the globe, without a window: a ball of ground with a hill answers for the planet.

#include "render/viewer/navigator.h"

#include <gtest/gtest.h>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/horizon.h"

namespace render {
namespace {

using planet::degrees;
using planet::wgs84;
using Kind = InputEvent::Kind;

constexpr Lens lens{900, 1000, 800};

/// Flat ground at h = 0 but for a plateau of 3 km in the south.
double plateau(const glm::dvec3& normal) {
    return planet::geodetic_from_normal(normal).latitude < -1 * degrees ? 3000 : 0;
}

Ground flat_ground() {
    return {[](const glm::dvec3& origin, const glm::dvec3& way) -> std::optional<glm::dvec3> {
                const auto distance = planet::distance_to_ellipsoid(wgs84, origin, way);
                return distance ? std::optional(origin + *distance * way) : std::nullopt;
            },
            plateau};
}

Pose pose_at(double latitude, double longitude, double h, double heading, double pitch) {
    return {planet::normal_from_geodetic(latitude * degrees, longitude * degrees), h, heading * degrees,
            pitch * degrees};
}

InputEvent event(Kind kind, double x, double y, double seconds, MouseButton button = MouseButton::left) {
    InputEvent e{.kind = kind};
    e.button = button;
    e.x = x;
    e.y = y;
    e.seconds = seconds;
    return e;
}

glm::dvec3 ground_at(const Navigator& n, const glm::dvec2& pixel) {
    return *flat_ground().pick(n.pose().eye(), ray(n.pose(), lens, pixel));
}

/// Until nothing moves by itself.
int let_go(Navigator& n) {
    int steps = 0;
    for (; n.moves() && steps < 2000; ++steps) n.advance(0.016, lens, {});
    return steps;
}

TEST(Navigator, DragsTheGroundAndThrowsIt) {
    Navigator n(flat_ground(), pose_at(10, 10, 2e5, 20, -60));
    const glm::dvec3 point = ground_at(n, {500, 500});
    n.handle(event(Kind::button_down, 500, 500, 1), lens);
    for (int i = 1; i <= 10; ++i) {
        n.handle(event(Kind::motion, 500 + 12 * i, 500 - 5 * i, 1 + 0.016 * i), lens);
        n.advance(0.016, lens, {});
        EXPECT_LT(glm::distance(*pixel_of_point(n.pose(), lens, point), glm::dvec2(500 + 12 * i, 500 - 5 * i)), 1e-3);
    }
    const glm::dvec3 eye = n.pose().eye();
    n.handle(event(Kind::button_up, 620, 450, 1.17), lens);
    n.advance(0.016, lens, {});
    EXPECT_TRUE(n.moves());
    EXPECT_LT(let_go(n), 600);
    EXPECT_GT(glm::distance(n.pose().eye(), eye), 1000);
}

TEST(Navigator, AHandThatRestsThrowsNothing) {
    Navigator n(flat_ground(), pose_at(10, 10, 2e5, 20, -60));
    n.handle(event(Kind::button_down, 500, 500, 1), lens);
    for (int i = 1; i <= 10; ++i) {
        n.handle(event(Kind::motion, 500 + 12 * i, 500, 1 + 0.016 * i), lens);
        n.advance(0.016, lens, {});
    }
    n.handle(event(Kind::button_up, 620, 500, 1.5), lens);
    n.advance(0.016, lens, {});
    EXPECT_FALSE(n.moves());
}

// All of a drag in one slow frame: whether the hand moved when it let go cannot be known.
TEST(Navigator, ASlowFrameThrowsNothing) {
    Navigator n(flat_ground(), pose_at(10, 10, 2e5, 20, -60));
    n.handle(event(Kind::button_down, 500, 500, 1), lens);
    n.advance(0.016, lens, {});
    for (int i = 1; i <= 10; ++i) n.handle(event(Kind::motion, 500 + 12 * i, 500, 1.5), lens);
    n.handle(event(Kind::button_up, 620, 500, 1.5), lens);
    n.advance(0.5, lens, {});
    EXPECT_FALSE(n.moves());
}

TEST(Navigator, TheWheelKeepsTheGroundUnderTheCursor) {
    Navigator n(flat_ground(), pose_at(40, -100, 8e6, 0, -90));
    const glm::dvec2 pixel(620, 330);
    const glm::dvec3 point = ground_at(n, pixel);
    const double far = glm::distance(n.pose().eye(), point);
    for (int i = 0; i < 20; ++i) {
        InputEvent e = event(Kind::wheel, pixel.x, pixel.y, 0.1 * i);
        e.wheel = 1;
        n.handle(e, lens);
        for (int k = 0; k < 6; ++k) n.advance(0.016, lens, {});
    }
    let_go(n);
    EXPECT_LT(glm::distance(n.pose().eye(), point), 0.2 * far);
    EXPECT_LT(glm::distance(*pixel_of_point(n.pose(), lens, point), pixel), 1);
}

TEST(Navigator, NeverGoesBelowTheGround) {
    Navigator n(flat_ground(), pose_at(-0.95, 20, 400, 180, -10));
    for (int i = 0; i < 300; ++i) {
        n.advance(0.05, lens, {.forward = 1});
        EXPECT_GE(n.clearance(), least_clearance_m - 1e-6);
    }
    EXPECT_LT(planet::geodetic_from_normal(n.pose().normal).latitude, -1 * degrees) << "it never reached the plateau";
    EXPECT_GE(n.pose().h, 3000 + least_clearance_m - 1e-6);
    for (int i = 0; i < 200; ++i) {
        n.advance(0.05, lens, {.nearer = 1, .tilt = -1});
        EXPECT_GE(n.clearance(), least_clearance_m - 1e-6);
    }
}

TEST(Navigator, ADoubleClickFliesThere) {
    Navigator n(flat_ground(), pose_at(20, 30, 3e6, 0, -90));
    const glm::dvec3 point = ground_at(n, {700, 250});
    for (const double t : {1.0, 1.2}) {
        n.handle(event(Kind::button_down, 700, 250, t), lens);
        n.handle(event(Kind::button_up, 700, 250, t + 0.05), lens);
    }
    EXPECT_TRUE(n.flies());
    let_go(n);
    EXPECT_LT(glm::distance(*pixel_of_point(n.pose(), lens, point), lens.middle()), 0.5);
    EXPECT_NEAR(n.clearance() / 1e6, 0.9, 0.15);
}

// A flight begins where the eye is and ends where it should, without a jump on the way.
TEST(Navigator, FlightsAreSmooth) {
    for (const Pose& from :
         {pose_at(46, 8, 5000, 70, -15), pose_at(46, 8, 5000, 70, 20), pose_at(-10, 100, 1e7, 0, -90)}) {
        Navigator n(flat_ground(), from);
        n.fly_to(planet::normal_from_geodetic(37.5 * degrees, -105.5 * degrees), 20'000, lens);
        n.advance(0, lens, {});
        EXPECT_LT(glm::distance(n.pose().eye(), from.eye()), 1e-3 * from.h);
        EXPECT_LT(glm::distance(*pixel_of_direction(n.pose(), lens, ray(from, lens, lens.middle())), lens.middle()), 1);
        double largest = 0;
        Pose last = n.pose();
        int steps = 0;
        for (; n.flies() && steps < 2000; ++steps) {
            n.advance(0.016, lens, {});
            const double way = glm::distance(n.pose().eye(), last.eye()) / std::max(n.clearance(), 1000.0);
            largest = std::max(largest, way);
            last = n.pose();
        }
        EXPECT_LT(steps, 600);
        EXPECT_LT(largest, 0.25) << "a jump, from pitch " << from.pitch;
        const auto middle = ground_at(n, lens.middle());
        EXPECT_NEAR(glm::distance(middle, n.pose().eye()), 20'000, 50);
    }
}

TEST(Navigator, NorthUpAndStraightDown) {
    Navigator n(flat_ground(), pose_at(46, 8, 5000, 130, -35));
    const glm::dvec3 middle = ground_at(n, lens.middle());
    n.north_up(lens);
    let_go(n);
    EXPECT_NEAR(std::remainder(n.pose().heading, 6.283185307179586), 0, 1e-3);
    EXPECT_LT(glm::distance(ground_at(n, lens.middle()), middle), 1);
    n.look_down(lens);
    let_go(n);
    EXPECT_NEAR(n.pose().pitch, -90 * degrees, 1e-6);
    EXPECT_LT(glm::distance(ground_at(n, lens.middle()), middle), 1);
    n.fly_home(lens);
    let_go(n);
    EXPECT_GT(n.pose().h, 5e6);
}

TEST(Navigator, AHandStopsAFlight) {
    Navigator n(flat_ground(), pose_at(46, 8, 5000, 70, -45));
    n.fly_home(lens);
    for (int i = 0; i < 20; ++i) n.advance(0.016, lens, {});
    n.handle(event(Kind::button_down, 500, 400, 9), lens);
    EXPECT_FALSE(n.moves());
}

}  // namespace
}  // namespace render
