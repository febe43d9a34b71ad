#pragma once
// From codes to directions and back. A split vertex is the midpoint of its two ends, projected back to the sphere:
// normalize(a + b) in double. a + b commutes, so both cells that share a side compute the same bits.
// The unit vector is the *geodetic* normal (frames.h), so latitude and longitude come without iteration.

#include <array>
#include <glm/glm.hpp>

#include "planet/octahedron/location_code.h"

namespace planet {

/// The corners of a cell as unit geodetic normals.
struct Corners {
    glm::dvec3 left, right, apex;
};

/// The split vertex between two corners. Exact in the sense above: the same bits from both sides of the split side.
inline glm::dvec3 split_vertex(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 s = a + b;
    return s / std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
}
inline glm::dvec3 split_vertex(const Corners& c) {
    return split_vertex(c.left, c.right);
}

/// The corners of child 0 or 1, given the split vertex m of the parent.
inline Corners child_corners(const Corners& c, const glm::dvec3& m, int child) {
    return child == 0 ? Corners{c.left, c.apex, m} : Corners{c.apex, c.right, m};
}

/// The corners of a whole face: exact unit axes.
Corners face_corners(int face);

/// The corners of any cell; O(level).
Corners corners(LocationCode cell);

/// The cell of the given bisection level that holds a direction (any length > 0, finite). A direction on a side belongs
/// to one of the cells that meet there, always the same one. -0 counts as 0.
LocationCode cell_at(const glm::dvec3& direction, int bisection_level);

/// Whether a cell is wound counter-clockwise seen from outside; alternates with the bisection level, and the faces of
/// both hemispheres are counter-clockwise.
constexpr bool is_counter_clockwise(LocationCode cell) {
    return (cell.bisection_level() & 1) == 0;
}

}  // namespace planet
