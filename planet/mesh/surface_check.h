#pragma once
// The proof that a mesh is a surface, with a border or closed.

#include <cstddef>
#include <string>

#include "planet/mesh/surface_mesh.h"
#include "planet/mesh/triangle_mesh.h"

namespace planet {

struct SurfaceCheck {
    std::size_t vertices = 0, triangles = 0, sides = 0;
    std::size_t border_sides = 0;      ///< sides of one triangle only: none in a closed mesh
    std::size_t wrong_sides = 0;       ///< sides of more than two triangles, or of two wound against each other
    std::size_t doubled_vertices = 0;  ///< distinct vertices at the same place: a T-junction or a crack hides there
    std::size_t degenerate = 0;        ///< triangles with a repeated vertex
    std::size_t unused_vertices = 0;
    std::size_t turned = 0;  ///< triangles that face down, or in ecef inwards, or have no area
    bool strips_match = false;
    long euler() const { return static_cast<long>(vertices) - static_cast<long>(sides) + static_cast<long>(triangles); }
    /// A surface with or without border.
    bool ok() const {
        return wrong_sides == 0 && doubled_vertices == 0 && degenerate == 0 && unused_vertices == 0 && turned == 0 &&
               strips_match;
    }
    /// Without border, and a sphere.
    bool closed() const { return ok() && border_sides == 0 && euler() == 2; }
    /// One line naming what fails, or "closed", or "sound" with its border.
    std::string summary() const;
};

/// O(n log n). @param frame says what faces outwards: ecef away from the centre, else up
SurfaceCheck check(const SurfaceMesh& mesh, MeshFrame frame);
/// Of the planet as it is drawn.
SurfaceCheck check(const TriangleMesh& mesh);

}  // namespace planet
