#pragma once
// What a picture of a mesh is made of, in picture coordinates: pixels from the top left, x right, y down, and z pixels
// towards the viewer.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/picture/mesh_picture.h"

namespace render {

/// 8 bits each, red lowest.
struct Color {
    std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
    friend bool operator==(const Color&, const Color&) = default;
};

constexpr Color with_alpha(Color c, double alpha) {
    return {c.red, c.green, c.blue, static_cast<std::uint8_t>(255 * alpha + 0.5)};
}

/// A line with round ends. A dot is one of length 0.
struct Stroke {
    glm::vec3 a{0}, b{0};
    float width = 1;  ///< pixels
    Color color{};
};

/// Three make a triangle.
struct FillCorner {
    glm::vec3 place{0};
    Color color{};  ///< alpha: how strongly the triangle's sides are drawn
};

struct PixelBox {
    float left = 0, top = 0, right = 0, bottom = 0;
};

/// Where a mesh lies in its picture.
struct MeshView {
    glm::dmat3 picture_from_mesh{1};  ///< pixels per unit; after subtracting the centre
    glm::dvec3 center{0};             ///< in the mesh's coordinates
    glm::dvec2 middle{0};             ///< where the centre lies in the picture
    PixelBox plot;                    ///< the mesh is drawn in here
    double legend_unit = 1;           ///< of lengths in the legend: 1 in a picture of 1200 x 1200
    double line_unit = 1;             ///< of widths of lines: the same, growing by the cube root
    std::vector<glm::vec3> places;    ///< of the vertices
    bool planet = false;

    glm::vec3 place(const glm::dvec3& v) const {
        return glm::vec3(picture_from_mesh * (v - center) + glm::dvec3(middle, 0));
    }
};

/// A legend is drawn, below the mesh, unless its letters were too small to read.
bool has_legend(const MeshPicture& picture);

/// Throws planet::Error (bad_data) for a mesh that has no extent.
MeshView make_mesh_view(const MeshPicture& picture);

/// The shape of a triangle in the picture.
struct Footprint {
    float area = 0;      ///< pixels
    float height = 0;    ///< over its longest side, pixels
    bool shown = false;  ///< it faces the viewer and has some area
};
inline Footprint footprint(const MeshView& view, const std::array<std::uint32_t, 3>& triangle) {
    const glm::vec2 a(view.places[triangle[0]]), b(view.places[triangle[1]]), c(view.places[triangle[2]]);
    const glm::vec2 u = b - a, v = c - a, w = c - b;
    const float turned = u.y * v.x - u.x * v.y;  // y is down: positive where counter-clockwise
    const float longest = std::sqrt(std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)}));
    return {.area = 0.5f * std::abs(turned),
            .height = longest > 0 ? std::abs(turned) / longest : 0,
            .shown = view.planet ? turned > 0 : turned != 0};
}

/// Brightness by vertex, 1 for level ground in a plan; empty if all is 1.
std::vector<float> vertex_shades(const MeshPicture& picture, const MeshView& view);

/// The colours of the levels or of the steps that a mesh has.
class MeshColors {
  public:
    explicit MeshColors(const MeshPicture& picture);

    bool steps() const { return steps_; }
    int first() const { return first_; }  ///< lowest level, or step 1
    int last() const { return last_; }    ///< highest level or step; below first() if no triangle merges
    /// Of a level or step; alpha: how strongly sides are drawn.
    Color of(int value) const;

  private:
    bool steps_;
    int first_ = 0, last_ = 0;
};

namespace figure_color {
inline constexpr Color paper{255, 255, 255}, ink{22, 30, 52};
inline constexpr Color curve{206, 26, 58}, curve_over_steps{32, 84, 168};
}  // namespace figure_color

/// In line units (MeshView).
inline constexpr float curve_width = 2.3f, ring_width = 1.6f, other_mark = 4.2f;

/// The mesh's border, its horizon if it is a planet, the curve and the marks, in the order of drawing.
struct MeshStrokes {
    std::vector<Stroke> list;
    bool has_curve = false;  ///< some of the curve is large enough to be seen
};
MeshStrokes mesh_strokes(const MeshPicture& picture, const MeshView& view);

/// The legend's swatches and lines, and the frame of a window.
struct Legend {
    std::vector<FillCorner> swatches;
    std::vector<Stroke> strokes;
};
Legend make_legend(const MeshPicture& picture, const MeshView& view, const MeshColors& colors, bool has_curve);

}  // namespace render
