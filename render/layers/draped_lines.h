#pragma once
// Lines on the drawn ground as pieces on the picture.

#include <functional>
#include <vector>

#include "planet/mesh/segment_surface.h"
#include "render/layers/geodesic_lines.h"
#include "render/picture/camera.h"

namespace render {

/// The ground that lines lie on.
struct DrapeGround {
    planet::SegmentSurface drawn;
    /// Metres above the ellipsoid at a unit geodetic normal, exaggerated: where nothing is drawn, beside the view.
    std::function<double(const glm::dvec3&)> height;
    planet::Culling culling;  ///< of what is drawn
    double relief_m = 9000;   ///< no ground is farther from the ellipsoid, exaggeration included

    /// Ecef, metres.
    glm::dvec3 point(const glm::dvec3& normal);
};

/// A straight piece of a line, or a point: from a to b. Pixels of the whole picture from its top left, and depth as it
/// is drawn (near / distance along the view axis).
struct ScreenPiece {
    glm::vec3 a, b;
};

/// The pieces of lines that a view may show, none longer than some three pixels, which are on the drawn triangles at
/// their ends. Vertices nearer to each other than a pixel are left out, but for the ends. Points are pieces of no length.
/// @param camera of the whole picture, so that all its parts have the same pieces
void drape(const GeodesicLines& lines, const Camera& camera, DrapeGround& ground, std::vector<ScreenPiece>& pieces);

/// Behind the ellipsoid, or one as far below it as the lowest ground: on the other side of the limb, to less than a pixel
/// of what is seen from space.
bool is_behind_planet(const glm::dvec3& eye, const glm::dvec3& point);

}  // namespace render
