#include "planet/octahedron/octahedron_map.h"

#include <cmath>

namespace planet {

namespace {

const glm::dvec3 equator[4] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};

int face_of(const glm::dvec3& d) {
    // Quadrants are half-open, [E_i, E_i+1): a direction on a meridian of an E_i belongs to the face to its east.
    int quadrant = 0;
    if (d.x > 0 && d.y >= 0)
        quadrant = 0;
    else if (d.x <= 0 && d.y > 0)
        quadrant = 1;
    else if (d.x < 0 && d.y <= 0)
        quadrant = 2;
    else if (d.x >= 0 && d.y < 0)
        quadrant = 3;
    return d.z >= 0 ? quadrant : 4 + quadrant;
}

}  // namespace

Corners face_corners(int face) {
    const glm::dvec3& e0 = equator[face & 3];
    const glm::dvec3& e1 = equator[(face + 1) & 3];
    if (face < 4) return {e0, e1, {0, 0, 1}};
    return {e1, e0, {0, 0, -1}};
}

Corners corners(LocationCode cell) {
    Corners c = face_corners(cell.face());
    for (int i = cell.bisection_level() - 1; i >= 0; --i)
        c = child_corners(c, split_vertex(c), static_cast<int>(cell.bits() >> i & 1));
    return c;
}

LocationCode cell_at(const glm::dvec3& direction, int bisection_level) {
    LocationCode cell = LocationCode::face_root(face_of(direction));
    Corners c = face_corners(cell.face());
    for (int level = 0; level < bisection_level; ++level) {
        const glm::dvec3 m = split_vertex(c);
        // The plane through the centre, m and the apex parts the children; left is on child 0's side.
        const glm::dvec3 plane = glm::cross(m, c.apex);
        const double side = glm::dot(plane, direction);
        const double left = glm::dot(plane, c.left);
        const int child = (side == 0 || (side > 0) == (left > 0)) ? 0 : 1;
        cell = cell.child(child);
        c = child_corners(c, m, child);
    }
    return cell;
}

}  // namespace planet
