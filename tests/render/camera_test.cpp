// The camera's matrices against the pinhole camera they stand for, written out here.

#include "render/picture/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planet/geodesy/ellipsoid.h"

namespace render {
namespace {

using planet::degrees;

class Dice {
  public:
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
    }
    glm::dvec3 direction() {
        return planet::normal_from_geodetic(std::asin(between(-1, 1)), between(-180, 180) * degrees);
    }

  private:
    std::mt19937_64 engine_{7};
};

Camera camera_at(double latitude, double longitude, double eye_height, double heading, double pitch, int width,
                 int height, double fov = 40) {
    const glm::dvec3 normal = planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
    return make_camera(planet::ecef_from_normal(planet::wgs84, normal, {eye_height}), normal, heading * degrees,
                       pitch * degrees, focal_length_px(fov * degrees, width, height), width, height);
}

/// Pixel in a part, from the top left, as OpenGL gets there from clip coordinates.
glm::dvec2 pixel_in_part(const Camera& camera, const PicturePart& part, const glm::dvec3& from_eye) {
    const glm::vec4 clip = camera.clip_from_ecef(part) * glm::vec4(glm::vec3(from_eye), 1);
    return {0.5 * part.width * (1 + static_cast<double>(clip.x) / clip.w),
            0.5 * part.height * (1 - static_cast<double>(clip.y) / clip.w)};
}

PicturePart whole(const Camera& camera) {
    return {0, 0, camera.width, camera.height};
}

/// The parts of a picture in the grid that starts at the top left.
std::vector<PicturePart> parts_of(const Camera& camera, int side) {
    std::vector<PicturePart> parts;
    for (int y = 0; y < camera.height; y += side)
        for (int x = 0; x < camera.width; x += side)
            parts.push_back({x, y, std::min(side, camera.width - x), std::min(side, camera.height - y)});
    return parts;
}

const Camera cameras[] = {
    camera_at(37.58, -105.49, 3e3, 30, -25, 1920, 1080), camera_at(0, 0, 20000e3, 0, -90, 640, 480),
    camera_at(90, 0, 1e6, 123, -60, 500, 700),           camera_at(-90, 0, 2, 10, 0, 1, 1),
    camera_at(-16.5, 180, 500, 270, 15, 300, 200, 150),  camera_at(12, -180, 5e7, 359, -90, 2048, 2048, 1),
    camera_at(-40, 45, 10e3, 90, -45, 5000, 3000),
};

TEST(Camera, PutsKnownDirectionsOnTheirPixels) {
    // Over (0, 0), where x is up, y east, z north: looking down, the heading is up in the picture.
    const double h = 1e6;
    const Camera down = camera_at(0, 0, h, 0, -90, 800, 600);
    const auto pixel = [](const Camera& c, const glm::dvec3& from_eye) { return pixel_in_part(c, whole(c), from_eye); };
    const double f = 300 / std::tan(20 * degrees);
    EXPECT_NEAR(down.focal_px, f, 1e-9);
    EXPECT_LT(glm::distance(pixel(down, {-h, 0, 0}), {400, 300}), 1e-3);
    EXPECT_LT(glm::distance(pixel(down, {-h, 1e5, 0}), {400 + f * 0.1, 300}), 1e-3);  // east is right
    EXPECT_LT(glm::distance(pixel(down, {-h, 0, 1e5}), {400, 300 - f * 0.1}), 1e-3);  // north is up
    const Camera turned = camera_at(0, 0, h, 90, -90, 800, 600);
    EXPECT_LT(glm::distance(pixel(turned, {-h, 1e5, 0}), {400, 300 - f * 0.1}), 1e-3);  // east is up
    EXPECT_LT(glm::distance(pixel(turned, {-h, 0, 1e5}), {400 - f * 0.1, 300}), 1e-3);  // north is left

    const Camera east = camera_at(0, 0, h, 90, 0, 800, 600);
    EXPECT_LT(glm::distance(pixel(east, {0, 1, 0}), {400, 300}), 1e-3);
    EXPECT_LT(glm::distance(pixel(east, {std::tan(20 * degrees), 1, 0}), {400, 0}), 1e-3);  // the field's upper border
    const Camera above = camera_at(0, 0, h, 0, 30, 800, 600);  // the horizontal is 30 degrees below the middle
    EXPECT_LT(glm::distance(pixel(above, {0, 0, 1}), {400, 300 + f * std::tan(30 * degrees)}), 1e-3);
}

TEST(Camera, FieldOfViewIsAcrossTheShorterSide) {
    EXPECT_DOUBLE_EQ(focal_length_px(90 * degrees, 300, 200), 100);
    EXPECT_DOUBLE_EQ(focal_length_px(90 * degrees, 200, 300), 100);
    for (const Camera& camera : cameras)
        EXPECT_NEAR(camera.tan_corner(), std::hypot(camera.width, camera.height) / 2 / camera.focal_px, 1e-12);
}

TEST(Camera, ViewIsARotationAndTheEyeIsOnTheGrid) {
    for (const Camera& camera : cameras) {
        const glm::dmat3 unit = camera.view_from_ecef * glm::transpose(camera.view_from_ecef);
        for (int i = 0; i < 3; ++i) EXPECT_LT(glm::distance(unit[i], glm::dmat3(1)[i]), 1e-15);
        EXPECT_NEAR(glm::determinant(camera.view_from_ecef), 1, 1e-15);
        EXPECT_EQ(camera.eye, planet::ecef_from_grid_eye(camera.grid_eye));
    }
}

TEST(Camera, DirectionsAndClipAreInverse) {
    Dice dice;
    for (const Camera& camera : cameras)
        for (const PicturePart& part : parts_of(camera, 2048))
            for (int i = 0; i < 200; ++i) {
                const glm::vec4 clip(dice.between(-1, 1), dice.between(-1, 1), 0, 1);
                const glm::vec3 ray(camera.ecef_direction_from_clip(part) * clip);
                const glm::vec4 back = camera.clip_from_ecef(part) * glm::vec4(ray * 1000.0f, 1);
                ASSERT_GT(back.w, 0);
                EXPECT_NEAR(back.x / back.w, clip.x, 2e-5);
                EXPECT_NEAR(back.y / back.w, clip.y, 2e-5);
            }
}

TEST(Camera, DepthIsReversed) {
    for (const Camera& camera : cameras) {
        const auto depth = [&](double ahead) {
            const glm::dvec3 from_eye = -ahead * glm::transpose(camera.view_from_ecef)[2];
            const glm::vec4 clip = camera.clip_from_ecef(whole(camera)) * glm::vec4(glm::vec3(from_eye), 1);
            return clip.z / clip.w;
        };
        EXPECT_NEAR(depth(camera.near_m), 1, 1e-6);
        for (const double ahead : {1.0, 1e3, 1e8}) EXPECT_NEAR(depth(ahead) * ahead / camera.near_m, 1, 1e-6);
    }
}

// Wherever a picture is cut, a point is on the same pixel: parts drawn alone are the whole.
TEST(Camera, PartsAgree) {
    Dice dice;
    for (const Camera& camera : cameras)
        for (const int side : {2048, 700})
            for (const PicturePart& part : parts_of(camera, side))
                for (int i = 0; i < 50; ++i) {
                    // In the part or up to a quarter of its size beside it.
                    const double x = part.x + part.width * dice.between(-0.25, 1.25),
                                 y = part.y + part.height * dice.between(-0.25, 1.25);
                    const glm::dvec3 view((x - 0.5 * camera.width) / camera.focal_px,
                                          (0.5 * camera.height - y) / camera.focal_px, -1);
                    const glm::dvec3 from_eye = glm::transpose(camera.view_from_ecef) * view * dice.between(1, 1e6);
                    const glm::dvec2 pixel = pixel_in_part(camera, part, from_eye) + glm::dvec2(part.x, part.y);
                    // A few roundings to float of a direction, seen from focal_px away.
                    EXPECT_LT(glm::distance(pixel, {x, y}), 0x1p-21 * std::hypot(camera.focal_px, camera.width));
                }
}

TEST(Camera, CullingAgreesWithClip) {
    Dice dice;
    std::size_t shown = 0, hidden = 0;
    for (const Camera& camera : cameras)
        for (const PicturePart& part : parts_of(camera, 2048)) {
            const planet::Culling culling = camera.culling(part, 0);
            EXPECT_EQ(culling.eye, camera.eye);
            const glm::mat4 clip_from_ecef = camera.clip_from_ecef(part);
            for (int i = 0; i < 2000; ++i) {
                // Half of them near the part's pyramid.
                const glm::vec4 near(dice.between(-1.2, 1.2), dice.between(-1.2, 1.2), 0, 1);
                const glm::dvec3 direction =
                    i % 2 ? dice.direction() : glm::normalize(glm::dvec3(camera.ecef_direction_from_clip(part) * near));
                const glm::dvec3 to = direction * dice.between(1, 1e5);
                const glm::dvec4 clip = glm::dmat4(clip_from_ecef) * glm::dvec4(to, 1);
                const double margin = std::max(std::abs(clip.x), std::abs(clip.y)) - clip.w;  // < 0: in the pyramid
                const bool hides = culling.hidden(camera.eye + to, 0);
                EXPECT_FALSE(hides && margin < -1e-4 * glm::length(to));
                EXPECT_FALSE(!hides && margin > 1e-4 * glm::length(to));
                ++(hides ? hidden : shown);
            }
        }
    EXPECT_GT(shown, 1000u);
    EXPECT_GT(hidden, 1000u);
}

// What culling calls hidden shows nowhere, however large: no point of the ball is in the picture.
TEST(Camera, HiddenBallsAreOutsideThePicture) {
    Dice dice;
    std::size_t hidden = 0;
    for (const Camera& camera : cameras) {
        const PicturePart part = whole(camera);
        const planet::Culling culling = camera.culling(part, 0);
        const glm::dmat4 clip_from_ecef(camera.clip_from_ecef(part));
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 centre = dice.direction() * dice.between(1, 1e4);
            const double radius = dice.between(0, 5e3);
            if (!culling.hidden(camera.eye + centre, radius)) continue;
            ++hidden;
            for (int k = 0; k < 40; ++k) {
                const glm::dvec3 to = centre + radius * dice.direction();
                const glm::dvec4 clip = clip_from_ecef * glm::dvec4(to, 1);
                EXPECT_GT(std::max(std::abs(clip.x), std::abs(clip.y)) - clip.w, -1e-4 * glm::length(to));
            }
        }
    }
    EXPECT_GT(hidden, 200u);
}

// Behind the planet: exact for points, against the distance along the ray to the ball.
TEST(Camera, CullingHidesWhatIsBehindThePlanet) {
    Dice dice;
    const double ball = planet::wgs84.b - 500;
    std::size_t hidden = 0, shown = 0;
    for (const Camera& camera : cameras) {
        planet::Culling culling = camera.culling(whole(camera), ball);
        culling.inward = {};
        for (int i = 0; i < 3000; ++i) {
            const glm::dvec3 p = planet::ecef_from_normal(planet::wgs84, dice.direction(), {dice.between(0, 9e3)});
            const glm::dvec3 ray = glm::normalize(p - camera.eye);
            const double along = -glm::dot(camera.eye, ray);
            const double miss2 = glm::dot(camera.eye, camera.eye) - along * along;
            const bool behind = along > 0 && miss2 < ball * ball && glm::distance(p, camera.eye) > along;
            const bool hides = culling.hidden(p, 0);
            EXPECT_FALSE(hides && !behind) << i;
            EXPECT_FALSE(!hides && behind && miss2 < 0.9999 * ball * ball) << i;
            ++(hides ? hidden : shown);
        }
    }
    EXPECT_GT(hidden, 1000u);
    EXPECT_GT(shown, 500u);
}

}  // namespace
}  // namespace render
