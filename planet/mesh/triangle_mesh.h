#pragma once
// A mesh as plain arrays: what crosses borders.

#include <array>
#include <cstdint>
#include <vector>

#include "planet/mesh/grid.h"
#include "planet/octahedron/location_code.h"

namespace planet {

struct TriangleMesh {
    std::vector<GridPosition> vertices;                   ///< unique
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
    std::vector<LocationCode> cells;                      ///< by triangle, in Sierpinski order
    std::vector<std::uint32_t> strip;                     ///< one generalized strip over all triangles, in order
};

}  // namespace planet
