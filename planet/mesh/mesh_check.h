#pragma once
// The proof that a mesh is a closed surface.

#include <cstddef>
#include <string>

#include "planet/mesh/triangle_mesh.h"

namespace planet {

struct MeshCheck {
    std::size_t vertices = 0, sides = 0, triangles = 0;
    std::size_t open_sides = 0;        ///< sides that do not have exactly two triangles, one in each direction
    std::size_t doubled_vertices = 0;  ///< distinct vertices at the same place: a T-junction or a crack hides there
    std::size_t degenerate = 0;        ///< triangles with a repeated vertex
    std::size_t unused_vertices = 0;
    std::size_t inward = 0;      ///< triangles whose normal points to the planet's centre
    bool strip_matches = false;  ///< the strip draws exactly the triangles, same winding, same order
    long euler() const { return static_cast<long>(vertices) - static_cast<long>(sides) + static_cast<long>(triangles); }
    bool ok() const {
        return open_sides == 0 && doubled_vertices == 0 && degenerate == 0 && unused_vertices == 0 && inward == 0 &&
               strip_matches && euler() == 2;
    }
    /// One line naming what fails, or "closed".
    std::string summary() const;
};

/// Every side has two triangles, V - E + F = 2, no vertex twice, outward, strip equal to list. O(n log n).
MeshCheck check(const TriangleMesh& mesh);

}  // namespace planet
