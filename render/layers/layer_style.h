#pragma once
// How a layer of points, lines and polygons looks.

#include <glm/glm.hpp>

namespace render {

inline constexpr double label_size_px = 15;

struct LayerStyle {
    glm::vec3 color{1, 0.8f, 0};  ///< sRGB as it is shown, 0..1
    double width = 2;             ///< pixels, of lines and outlines; marks of points are 4.5 times as wide
    double opacity = 1;           ///< 0..1
    double fill = 0.2;            ///< 0..1: what of the opacity the inside of a polygon has
    bool casing = true;           ///< a dark rim, which parts light lines from light ground
};

}  // namespace render
