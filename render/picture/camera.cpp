#include "render/picture/camera.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/local_frame.h"

namespace render {

namespace {

struct Axes {
    glm::dvec3 right, up, ahead;
};

Axes axes_of(const glm::dvec3& at, double heading, double pitch) {
    const glm::dmat3 enu = planet::ecef_from_enu(at);
    const glm::dvec3 east = enu[0], north = enu[1], up = enu[2];
    const glm::dvec3 level = std::sin(heading) * east + std::cos(heading) * north;
    const glm::dvec3 right = std::cos(heading) * east - std::sin(heading) * north;
    const double c = std::cos(pitch), s = std::sin(pitch);
    return {right, c * up - s * level, c * level + s * up};
}

}  // namespace

glm::dvec3 look_direction(const glm::dvec3& at, double heading, double pitch) {
    return axes_of(at, heading, pitch).ahead;
}

double focal_length_px(double fov, int width, int height) {
    return 0.5 * std::min(width, height) / std::tan(0.5 * fov);
}

double whole_globe_range(double fov) {
    constexpr double air_m = 60e3, share = 0.94;
    return (planet::wgs84.a + air_m) / std::sin(0.5 * share * fov) - planet::wgs84.a;
}

Camera make_camera(const glm::dvec3& eye, const glm::dvec3& at, double heading, double pitch, double focal_px,
                   int width, int height) {
    Camera c;
    c.grid_eye = planet::grid_eye(eye);
    c.eye = planet::ecef_from_grid_eye(c.grid_eye);
    const Axes axes = axes_of(at, heading, pitch);
    c.view_from_ecef = glm::transpose(glm::dmat3(axes.right, axes.up, -axes.ahead));
    c.focal_px = focal_px;
    c.width = width;
    c.height = height;
    return c;
}

std::optional<glm::dvec3> screen_from_ecef(const Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 view = camera.view_from_ecef * (point - camera.eye);
    if (!(-view.z > camera.near_m)) return std::nullopt;
    const double scale = camera.focal_px / -view.z;
    return glm::dvec3(0.5 * camera.width + scale * view.x, 0.5 * camera.height - scale * view.y,
                      camera.near_m / -view.z);
}

glm::dvec3 ecef_from_screen(const Camera& camera, const glm::dvec3& at) {
    const double ahead = camera.near_m / at.z, across = ahead / camera.focal_px;
    const glm::dvec3 view(across * (at.x - 0.5 * camera.width), across * (0.5 * camera.height - at.y), -ahead);
    return camera.eye + glm::transpose(camera.view_from_ecef) * view;
}

glm::dmat4 Camera::clip_from_view(const PicturePart& part) const {
    // A view vector (X, Y, Z) meets the picture at pixel (width/2 + f X/-Z, height/2 - f Y/-Z) from the top left; the
    // part's pixels x .. x + part.width go to -1 .. 1, and y down becomes y up. Depth: near / -Z, 1 at near, 0 at
    // infinity.
    const double sx = 2 * focal_px / part.width, sy = 2 * focal_px / part.height;
    const double ox = (width - 2.0 * part.x) / part.width - 1, oy = 1 - (height - 2.0 * part.y) / part.height;
    glm::dmat4 m(0);
    m[0] = {sx, 0, 0, 0};
    m[1] = {0, sy, 0, 0};
    m[2] = {-ox, -oy, 0, -1};
    m[3] = {0, 0, near_m, 0};
    return m;
}

glm::mat4 Camera::clip_from_ecef(const PicturePart& part) const {
    return glm::mat4(clip_from_view(part) * glm::dmat4(view_from_ecef));
}

glm::mat4 Camera::ecef_direction_from_clip(const PicturePart& part) const {
    // At Z = -1: X = (x - ox) / sx, Y = (y - oy) / sy.
    const glm::dmat4 p = clip_from_view(part);
    glm::dmat4 view(0);
    view[0].x = 1 / p[0].x;
    view[1].y = 1 / p[1].y;
    view[3] = {p[2].x / p[0].x, p[2].y / p[1].y, -1, 0};
    return glm::mat4(glm::dmat4(glm::transpose(view_from_ecef)) * view);
}

planet::Culling Camera::culling(const PicturePart& part, double occluder_radius) const {
    const glm::dmat3 ecef_from_view = glm::transpose(view_from_ecef);
    // Slopes of the part's borders: right of x0, left of x1, above y0, below y1, for a view vector at Z = -1.
    const double x0 = (part.x - 0.5 * width) / focal_px, x1 = (part.x + part.width - 0.5 * width) / focal_px;
    const double y1 = (0.5 * height - part.y) / focal_px, y0 = (0.5 * height - part.y - part.height) / focal_px;
    planet::Culling c;
    c.eye = eye;
    c.inward = {glm::dvec3(1, 0, x0), glm::dvec3(-1, 0, -x1), glm::dvec3(0, 1, y0), glm::dvec3(0, -1, -y1)};
    for (glm::dvec3& n : c.inward) n = ecef_from_view * glm::normalize(n);
    c.occluder_radius = occluder_radius;
    return c;
}

double Camera::tan_corner() const {
    return std::hypot(0.5 * width, 0.5 * height) / focal_px;
}

}  // namespace render
