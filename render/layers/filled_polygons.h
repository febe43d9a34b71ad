#pragma once
// Polygons to fill: rings on the ellipsoid whose sides are geodesics, as walls along verticals. A place on the ground lies in
// as many polygons as a ray from the eye to it enters and does not leave, and the eye's own place in them is where it
// begins to count: so polygons need no triangles of their own, whatever ground they lie on.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/elevation/features.h"
#include "render/picture/camera.h"

namespace render {

struct PolygonWalls {
    std::vector<glm::vec4>
        triangles;  ///< three vertices each, counter-clockwise from outside; relative to the eye, m, or (w 0) a direction
    int around_eye = 0;  ///< polygons below or above the eye
};

class FilledPolygons {
  public:
    /// The inside of a ring is the smaller of the two areas it parts, whichever way it turns.
    void add(const planet::Polygon& polygon);
    bool empty() const { return rings_.empty(); }

    /// @param lowest_m no ground is deeper below the ellipsoid
    PolygonWalls walls(const Camera& camera, double lowest_m) const;

  private:
    void add_ring(std::span<const glm::dvec3> closed, bool hole);

    std::vector<std::vector<glm::dvec3>> rings_;  ///< normals, not repeated; the inside of a polygon is to the left
};

}  // namespace render
