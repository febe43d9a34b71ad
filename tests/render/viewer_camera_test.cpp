// The viewer's camera without a window: what is held stays in its pixel.

#include "render/viewer/camera.h"

#include <gtest/gtest.h>

#include <numbers>
#include <ostream>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/horizon.h"
#include "planet/geodesy/local_frame.h"

namespace render {
namespace {

using planet::degrees;
using planet::wgs84;

constexpr Lens lens{1000, 1280, 720};

Pose pose_at(double latitude, double longitude, double h, double heading, double pitch) {
    return {planet::normal_from_geodetic(latitude * degrees, longitude * degrees), h, heading * degrees,
            pitch * degrees};
}

std::optional<glm::dvec3> ellipsoid_point(const Pose& pose, const glm::dvec2& pixel) {
    const glm::dvec3 way = ray(pose, lens, pixel);
    const auto distance = planet::distance_to_ellipsoid(wgs84, pose.eye(), way);
    return distance ? std::optional(pose.eye() + *distance * way) : std::nullopt;
}

double pixels_off(const Pose& pose, const glm::dvec3& point, const glm::dvec2& pixel) {
    const auto at = pixel_of_point(pose, lens, point);
    return at ? glm::distance(*at, pixel) : 1e9;
}

struct Case {
    const char* name;
    double latitude, longitude, h, heading, pitch;
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

constexpr Case cases[] = {
    {"WholeGlobe", 12, 12, 1.9e7, 0, -90},     {"GlobeTurned", 50, -100, 9e6, 130, -90},
    {"FromAfarTilted", 30, 80, 2e6, 200, -60}, {"Country", -33, 151, 4e5, 10, -70},
    {"Valley", 37.5, -105.5, 6000, 290, -25},  {"LowAndFlat", 46.8, 8.2, 1500, 77, -12},
    {"Street", 48.86, 2.29, 60, 350, -40},     {"NearThePole", 89.2, 30, 2e5, 45, -60},
    {"DateLine", 10, 179.99, 3e5, 0, -80},     {"SouthPole", -90, 0, 3e6, 0, -90},
};

class Poses : public testing::TestWithParam<Case> {
  protected:
    Pose pose() const {
        const Case& c = GetParam();
        return pose_at(c.latitude, c.longitude, c.h, c.heading, c.pitch);
    }
};
INSTANTIATE_TEST_SUITE_P(Viewer, Poses, testing::ValuesIn(cases),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(Poses, RaysAndPixelsAreInverse) {
    for (const glm::dvec2 pixel :
         {glm::dvec2(640, 360), glm::dvec2(0, 0), glm::dvec2(1280, 720), glm::dvec2(17.25, 600)}) {
        const auto back = pixel_of_direction(pose(), lens, ray(pose(), lens, pixel));
        ASSERT_TRUE(back);
        EXPECT_LT(glm::distance(*back, pixel), 1e-9);
    }
}

TEST_P(Poses, AgreeWithTheCameraThatDraws) {
    const Camera camera = lens.camera(pose());
    const glm::dvec3 way = ray(pose(), lens, {900, 200});
    const glm::dvec3 view = camera.view_from_ecef * way;
    EXPECT_NEAR(640 + 1000 * view.x / -view.z, 900, 1e-8);
    EXPECT_NEAR(360 - 1000 * view.y / -view.z, 200, 1e-8);
    EXPECT_LT(glm::distance(camera.eye, pose().eye()), 1e-5);
}

TEST_P(Poses, AreMadeOfEyeAndDirection) {
    const Pose p = pose();
    const Pose again = pose_from(p.eye(), ray(p, lens, lens.middle()), ray(p, lens, {640, 360 - 1000}));
    EXPECT_LT(glm::distance(again.eye(), p.eye()), 1e-6);
    for (const glm::dvec2 pixel : {glm::dvec2(3, 5), glm::dvec2(1200, 700)})
        EXPECT_LT(glm::distance(*pixel_of_direction(again, lens, ray(p, lens, pixel)), pixel), 1e-6);
}

// The heart of it: a hundred steps of a drag, and the ground is where the cursor is, to a thousandth of a pixel.
TEST_P(Poses, ADragHoldsTheGround) {
    Pose p = pose();
    const glm::dvec2 from(600, 420);
    const auto point = ellipsoid_point(p, from);
    ASSERT_TRUE(point);
    const double h = p.h;
    int i = 1;
    for (; i <= 100; ++i) {
        const glm::dvec2 pixel = from + glm::dvec2(1.6 * i, -0.7 * i + 40 * std::sin(0.2 * i));
        if (!ellipsoid_point(p, pixel)) break;  // above the horizon
        const Held held = hold(p, lens, *point, pixel, Compass::kept);
        if (!held.exact) break;  // beyond the limb
        p = held.pose;
        EXPECT_LT(pixels_off(p, *point, pixel), 1e-3) << "step " << i;
        EXPECT_NEAR(p.h, h, 1e-9);
        EXPECT_EQ(p.pitch, pose().pitch);
    }
    EXPECT_GT(i, GetParam().pitch > -15 ? 20 : 100) << "the ground was let go";
}

TEST(ViewerCamera, ADragReachesAllOfTheDisc) {
    const Pose p = pose_at(12, 12, 1.9e7, 0, -90);
    const auto point = ellipsoid_point(p, {640, 360});
    for (const glm::dvec2 pixel :
         {glm::dvec2(800, 360), glm::dvec2(640, 200), glm::dvec2(520, 480), glm::dvec2(740, 300)}) {
        const Held held = hold(p, lens, *point, pixel, Compass::kept);
        EXPECT_TRUE(held.exact) << pixel.x << ' ' << pixel.y;
        EXPECT_LT(pixels_off(held.pose, *point, pixel), 1e-3);
        EXPECT_EQ(held.pose.heading, 0) << "north stays up";
    }
}

TEST(ViewerCamera, ADragBeyondTheLimbStaysOnTheGlobe) {
    const Pose p = pose_at(12, 12, 1.9e7, 0, -90);
    const auto point = ellipsoid_point(p, {700, 300});
    const Held held = hold(p, lens, *point, {1270, 10}, Compass::kept);
    EXPECT_FALSE(held.exact);
    EXPECT_GT(glm::dot(held.pose.eye() - *point, *point), 0) << "the point went behind the globe";
    EXPECT_NEAR(held.pose.h, p.h, 1e-6);
}

TEST(ViewerCamera, ThePoleCanBeDragged) {
    Pose p = pose_at(75, 20, 5e6, 0, -90);
    const glm::dvec3 pole(0, 0, wgs84.b);
    const glm::dvec2 at = *pixel_of_point(p, lens, pole);
    for (int i = 1; i <= 60; ++i) {
        const glm::dvec2 pixel = at + glm::dvec2(4.0 * i, 2.0 * i);
        const Held held = hold(p, lens, pole, pixel, Compass::kept);
        ASSERT_TRUE(held.exact) << i;
        p = held.pose;
        EXPECT_LT(pixels_off(p, pole, pixel), 1e-3);
    }
}

TEST_P(Poses, ZoomingKeepsThePoint) {
    const glm::dvec2 pixel(660, 430);
    const auto point = ellipsoid_point(pose(), pixel);
    ASSERT_TRUE(point);
    Pose p = pose();
    for (int i = 0; i < 12; ++i) {
        const double before = glm::distance(p.eye(), *point);
        p = zoomed(p, lens, *point, pixel, 0.8, Compass::kept);
        EXPECT_LT(pixels_off(p, *point, pixel), 1e-3) << "nearer " << i;
        EXPECT_NEAR(glm::distance(p.eye(), *point) / before, 0.8, 0.08);
    }
    for (int i = 0; i < 12 && p.h < 1e7; ++i) {
        p = zoomed(p, lens, *point, pixel, 1.25, Compass::kept);
        EXPECT_LT(pixels_off(p, *point, pixel), 1e-3) << "farther " << i;
    }
}

TEST(ViewerCamera, ZoomingToAPeakAboveTheEye) {
    Pose p = pose_at(46, 8, 1000, 0, 2);
    const glm::dvec3 peak = planet::ecef_from_geodetic(wgs84, {46.1 * degrees, 8.01 * degrees, {2500}});
    const glm::dvec2 pixel = *pixel_of_point(p, lens, peak);
    const double before = glm::distance(p.eye(), peak);
    p = zoomed(p, lens, peak, pixel, 0.5, Compass::kept);
    EXPECT_NEAR(glm::distance(p.eye(), peak) / before, 0.5, 1e-6);
    EXPECT_LT(pixels_off(p, peak, pixel), 1e-3);
}

TEST(ViewerCamera, FromAfarThePlanetStaysInTheMiddle) {
    Pose p = pose_at(37, -105, 3000, 40, -10);
    const glm::dvec2 pixel(640, 600);
    const glm::dvec3 point = *ellipsoid_point(p, pixel);
    for (int i = 0; i < 45; ++i) p = zoomed(p, lens, point, pixel, 1.25, Compass::kept);
    EXPECT_GT(p.h, 2e6);
    EXPECT_TRUE(ellipsoid_point(p, lens.middle())) << "the middle of the picture shows the sky";
    EXPECT_LE(p.h, highest_eye_m);
}

TEST_P(Poses, OrbitingKeepsThePointAndTheDistance) {
    const glm::dvec2 pixel(700, 400);
    const auto point = ellipsoid_point(pose(), pixel);
    ASSERT_TRUE(point);
    Pose p = pose();
    const double distance = glm::distance(p.eye(), *point);
    for (int i = 0; i < 40; ++i) {
        p = orbited(p, lens, *point, pixel, 0.05, i < 20 ? 0.02 : -0.03);
        EXPECT_LT(pixels_off(p, *point, pixel), 1e-3) << i;
        EXPECT_NEAR(glm::distance(p.eye(), *point) / distance, 1, 1e-3);
        EXPECT_GE(p.pitch, -90 * degrees);
        EXPECT_LE(p.pitch, 89.0001 * degrees);
    }
}

// From afar, straight down, a turn turns the picture by just that, and not by what little the eye leans aside.
TEST(ViewerCamera, TurningFromAboveDoesNotSpin) {
    Pose p = pose_at(40, 20, 1e7, 0, -90);
    const glm::dvec2 pixel(760, 300);
    const glm::dvec3 point = *ellipsoid_point(p, pixel);
    for (int i = 1; i <= 20; ++i) {
        p = orbited(p, lens, point, pixel, 0.01, 0);
        EXPECT_NEAR(p.heading, 0.01 * i, 1e-9);
        EXPECT_LT(pixels_off(p, point, pixel), 1e-3);
    }
}

TEST(ViewerCamera, TheSkyCanBeDragged) {
    const Pose p = pose_at(46, 8, 2000, 30, 10);
    const glm::dvec3 star = ray(p, lens, {640, 100});
    const Held held = turn_to(p, lens, star, {300, 250});
    EXPECT_TRUE(held.exact);
    EXPECT_LT(glm::distance(*pixel_of_direction(held.pose, lens, star), glm::dvec2(300, 250)), 1e-3);
    EXPECT_LT(glm::distance(held.pose.eye(), p.eye()), 1e-9);
}

TEST(ViewerCamera, AGlideSlowsDownAndEnds) {
    Pose p = pose_at(10, 10, 5e5, 0, -90);
    Glide glide;
    for (int i = 0; i < 10; ++i) {
        const Pose next = moved(p, 4000, 1000, Compass::kept);
        glide.note(p, next, 0.016);
        p = next;
    }
    const Pose released = p;
    double last = 1e9;
    int steps = 0;
    for (; glide.moving() && steps < 1000; ++steps) {
        const Pose next = glide.advance(p, lens, 5e5, 0.016, Compass::kept);
        const double way = glm::distance(next.eye(), p.eye());
        EXPECT_LE(way, last * 1.0001);
        last = way;
        p = next;
    }
    EXPECT_LT(steps, 400);
    EXPECT_GT(glm::distance(p.eye(), released.eye()), 20'000);
    EXPECT_GT(planet::geodetic_from_normal(p.normal).longitude,
              planet::geodetic_from_normal(released.normal).longitude);
    // A hand that stops the globe throws nothing.
    glide.note(p, moved(p, 9000, 0, Compass::kept), 0.016);
    glide.stop();
    EXPECT_FALSE(glide.moving());
}

TEST(ViewerCamera, CarriedHeadingsPassThePoleWithoutASpin) {
    Pose p = pose_at(89.9, 0, 1e6, 0, -90);
    const glm::dvec3 up = ray(p, lens, {640, -1e6});
    for (int i = 0; i < 40; ++i) {
        const glm::dmat3 enu = planet::ecef_from_enu(p.normal);
        const glm::dvec3 way(0, 1, 0);  // across the pole
        p = moved(p, 1000 * glm::dot(way, enu[0]), 1000 * glm::dot(way, enu[1]), Compass::carried);
    }
    EXPECT_GT(glm::dot(ray(p, lens, {640, -1e6}), up), 0.99);
}

}  // namespace
}  // namespace render
