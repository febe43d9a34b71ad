#pragma once
// The triangulation itself as a figure: sides, bisection levels in colour, the curve along which its triangles follow each
// other, and the merging domain of a removed vertex. Plans have x right and y up; planets are seen from far outside.
//
//   auto context = render::Context::create();
//   write_image("mesh.png", render::draw_mesh_picture({.vertices = mesh.vertices, .triangles = mesh.triangles,
//                                                      .level = mesh.level, .relief = true}));

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "planet/elevation/image.h"

namespace render {

/// The part of a mesh that a picture shows: at least the square (plan) or disc (planet) around a place.
struct MeshWindow {
    glm::dvec3 center{0};  ///< in the mesh's coordinates
    double radius = 1;     ///< half the square's side in the units of x; the disc's radius in the planet's units
};

struct MeshPicture {
    std::span<const glm::dvec3> vertices;  ///< finite; a planet's centre is the origin
    /// Any winding in a plan; counter-clockwise seen from outside on a planet. Where one shares a side with the next, the
    /// curve runs from one to the other.
    std::span<const std::array<std::uint32_t, 3>> triangles;
    std::span<const std::uint8_t> level;  ///< bisection level, by triangle
    /// By triangle, or empty: the step in which it merges, 1 and up; 0: it stays. Takes the place of the levels.
    std::span<const std::uint8_t> step{};
    std::span<const glm::dvec3> marks{};  ///< removed vertices, first the one that was asked for

    bool planet = false;
    glm::dvec3 look_from{1, 0, 0};     ///< planet: from its centre towards the viewer, any length; north is up
    glm::dvec2 metres_per_unit{1, 1};  ///< plan: of x and y, for their proportion and for relief; z is in metres
    bool relief = false;               ///< shades the slopes, exaggerated until they show
    bool curve = true;
    std::optional<MeshWindow> window{};  ///< nothing: all of the mesh

    int width = 1600, height = 1600;  ///< pixels, picture_size_min .. picture_size_max
};

inline constexpr int picture_size_min = 64, picture_size_max = 16384;

/// The window that shows all triangles that merge and some of what stays around them; nothing if none merges.
std::optional<MeshWindow> merging_window(const MeshPicture& picture);

/// The height of the picture, between two others, at which its mesh, a plan, fills its width: what is left of it is the
/// margin and the legend. Throws planet::Error(bad_data) for a mesh without area.
int fitting_height(const MeshPicture& picture, int least, int most);

/// Draws with the context that is current on this thread, whose depth it reverses (framebuffer.h). The same bytes for the
/// same mesh. Sides and curve fade out where triangles are only a few pixels large.
/// Throws planet::Error: bad_usage for a size out of range; bad_data for a mesh without triangles, without area, with an
/// index or a coordinate that is none. Spans of the wrong length are misuse.
planet::Image draw_mesh_picture(const MeshPicture& picture);

}  // namespace render
