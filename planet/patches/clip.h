#pragma once
// A triangle of the lattice cut at the border of the raster.

#include <array>
#include <glm/glm.hpp>

#include "planet/patches/patch_raster.h"

namespace planet {

/// A vertex of a mesh of a raster: where in the lattice, and its height, metres. Sides are upright, level or diagonal,
/// and the border lies on samples, so that cuts do too.
struct LatticeVertex {
    glm::ivec2 at;
    double height;
};

/// A convex polygon of at most five corners, in the order of the triangle's.
struct ClippedTriangle {
    std::array<LatticeVertex, 5> corner;
    std::size_t count = 0;  ///< 0: nothing is left
};

/// Heights of cuts are interpolated from the ends of the side in a fixed order, so that both triangles at a side cut it
/// at the same bits.
ClippedTriangle clip(const PatchRaster& raster, const std::array<LatticeVertex, 3>& triangle);

}  // namespace planet
