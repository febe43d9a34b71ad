#pragma once
// Where a picture is taken from, and the matrices of its parts.

#include <glm/glm.hpp>
#include <optional>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/culling.h"
#include "planet/mesh/grid.h"

namespace render {

/// A part of a picture: parts lie on a grid fixed at the picture's top left, so that any of them drawn alone has the
/// pixels of the whole.
struct PicturePart {
    int x = 0, y = 0, width = 0, height = 0;  ///< pixels, from the top left
};

/// A pinhole camera. The eye is put on the planet-fixed grid, where the vertex shader has it.
struct Camera {
    planet::GridEye grid_eye;
    glm::dvec3 eye{0};             ///< ecef, m: exactly grid_eye
    glm::dmat3 view_from_ecef{1};  ///< rotation: rows right, up, back
    double focal_px = 1;
    int width = 1, height = 1;
    double near_m = 0.02;  ///< nothing nearer is drawn; the far end is at infinity

    /// Directions for the shader: clip = matrix * (position - eye, 1). Reversed depth, far plane at infinity.
    glm::mat4 clip_from_ecef(const PicturePart& part) const;
    /// Takes (x, y, 0, 1) of clip space to an ecef direction of any length.
    glm::mat4 ecef_direction_from_clip(const PicturePart& part) const;
    /// What a part cannot show. @param occluder_radius m, a ball no terrain lets light through
    planet::Culling culling(const PicturePart& part, double occluder_radius) const;
    /// Tangent of the angle between the view axis and a corner.
    double tan_corner() const;

  private:
    glm::dmat4 clip_from_view(const PicturePart& part) const;
};

/// Looking along a direction from a place. @param focal_px focal length in pixels
/// @param at geodetic normal whose local frame gives the angles @param heading rad clockwise from north
/// @param pitch rad, -pi/2 straight down (the heading is then up in the picture)
Camera make_camera(const glm::dvec3& eye, const glm::dvec3& at, double heading, double pitch, double focal_px,
                   int width, int height);

/// Where a point is on the picture: pixels from the top left, and depth as it is drawn (near / distance along the view axis).
/// Nothing behind the eye.
std::optional<glm::dvec3> screen_from_ecef(const Camera& camera, const glm::dvec3& point);

/// The point that is there on the picture. @param at pixels from the top left, and depth above 0
glm::dvec3 ecef_from_screen(const Camera& camera, const glm::dvec3& at);

/// By how much the distance along the view axis may be off that follows from a drawn depth, m, besides what it changes
/// within 1/64 pixel: vertices and depths are rounded to 24 bits (depth_pick_test).
inline double depth_resolution(double distance_m) {
    return 1e-4 + distance_m * 0x1p-20;
}

/// The direction of a heading and pitch at a geodetic normal, ecef, unit.
glm::dvec3 look_direction(const glm::dvec3& at, double heading, double pitch);

/// Focal length in pixels for a field of view across the shorter side. @param fov rad, below pi
double focal_length_px(double fov, int width, int height);

/// Distance from the ground from which the planet and its air fill most of the picture's shorter side, m. @param fov rad
double whole_globe_range(double fov);

}  // namespace render
