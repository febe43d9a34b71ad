#pragma once
// How a layer of points, lines and polygons looks.

#include <cmath>
#include <glm/glm.hpp>

namespace render {

inline constexpr double label_size_px = 15;
/// The radius of a point's mark in widths of a line.
inline constexpr double point_radius_widths = 2.25;

/// IEC 61966-2-1.
inline glm::vec3 linear_from_srgb(const glm::vec3& c) {
    const auto linear = [](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); };
    return {linear(c.r), linear(c.g), linear(c.b)};
}

struct LayerStyle {
    glm::vec3 color{1, 0.8f, 0};  ///< sRGB as it is shown, 0..1
    double width = 2;             ///< pixels, of lines and outlines; marks of points are 4.5 times as wide
    double opacity = 1;           ///< 0..1
    double fill = 0.2;            ///< 0..1: what of the opacity the inside of a polygon has
    bool own_colors = false;      ///< of a mesh's vertices, if it has any, instead
    bool casing = true;           ///< a dark rim, which parts light lines from light ground
};

}  // namespace render
