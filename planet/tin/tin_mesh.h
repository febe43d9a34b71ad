#pragma once
// A triangulation of a raster as plain arrays.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace planet {

struct TinMesh {
    std::vector<glm::ivec2> vertices;                     ///< (column, row) of samples; unique, all used
    std::vector<float> height;                            ///< metres, by vertex
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise with columns right and rows up
    std::vector<std::array<glm::ivec2, 2>> held_sides;    ///< that must stay, as features are on them: by their ends
};

}  // namespace planet
