#pragma once

#include <glm/glm.hpp>

#include "planet/octahedron/octahedron_map.h"

namespace planet {

/// A cap on the sphere of geodetic normals.
struct Cap {
    glm::dvec3 centre{0, 0, 1};  ///< unit
    double angle = 0;            ///< rad, 0..pi
};

/// A cap that holds the cell.
Cap cap_of(const Corners& cell);
Cap cap_of(LocationCode cell);

}  // namespace planet
