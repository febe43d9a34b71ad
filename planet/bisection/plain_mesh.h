#pragma once
// Triangles with what their vertices carry: what goes into a bisection, and what comes out.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace planet {

struct PlainMesh {
    std::vector<glm::dvec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< all turn the same way about the surface
    /// Colours, normals, texture coordinates: attribute_width numbers a vertex, vertex by vertex. A new vertex has the mean
    /// of the ends of the side that it splits; normals so become shorter than 1.
    std::vector<float> attributes = {};
    std::size_t attribute_width = 0;
};

}  // namespace planet
