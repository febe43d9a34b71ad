#include "planet/octahedron/cap.h"

#include <algorithm>
#include <cmath>

namespace planet {

Cap cap_of(const Corners& c) {
    const glm::dvec3 centre = glm::normalize(c.left + c.right + c.apex);
    double chord = 0;
    for (const glm::dvec3& corner : {c.left, c.right, c.apex}) chord = std::max(chord, glm::length(corner - centre));
    return {centre, 2 * std::asin(std::min(1.0, chord / 2)) * (1 + 1e-9) + 1e-15};
}

Cap cap_of(LocationCode cell) {
    return cap_of(corners(cell));
}

}  // namespace planet
