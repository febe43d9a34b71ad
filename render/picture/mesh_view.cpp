#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "planet/error.h"
#include "render/picture/mesh_figure.h"

namespace render {
namespace {

constexpr double figure_size = 1200;       ///< pixels of the shorter side at which lengths below are meant
constexpr double margin = 44;              ///< around everything
constexpr double legend_height = 96;       ///< below the mesh, with the distance to it
constexpr double least_legend_unit = 0.6;  ///< pixels; its letters could not be read below
constexpr double legend_from_size = 320;   ///< pixels of the shorter side

constexpr double least_window = 1e-9;  ///< of the mesh: pixels stay far within a float's range

int shorter_side(const MeshPicture& p) {
    return std::min(p.width, p.height);
}

/// Rows right, down, towards the viewer; a unit of length stays one.
glm::dmat3 planet_rotation(const glm::dvec3& look_from) {
    const double length = glm::length(look_from);
    if (!(length > 0) || !std::isfinite(length))
        throw planet::Error(planet::Fault::bad_usage, "a picture of a mesh", "no direction to look from");
    const glm::dvec3 near = look_from / length;
    // Above a pole the meridian of Greenwich points down.
    const bool polar = std::hypot(near.x, near.y) < 1e-9;
    const glm::dvec3 right =
        glm::normalize(glm::cross(polar ? glm::dvec3(near.z > 0 ? -1 : 1, 0, 0) : glm::dvec3(0, 0, 1), near));
    return glm::transpose(glm::dmat3(right, -glm::cross(near, right), near));
}

struct Bounds {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& v) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    glm::dvec3 size() const { return high - low; }
    glm::dvec3 center() const { return low + 0.5 * size(); }
};

PixelBox plot_of(const MeshPicture& p, double unit) {
    const double m = std::floor(margin * unit);
    const double below = has_legend(p) ? std::floor(legend_height * std::max(unit, least_legend_unit)) : 0;
    return {static_cast<float>(m), static_cast<float>(m), static_cast<float>(p.width - m),
            static_cast<float>(p.height - m - below)};
}

}  // namespace

bool has_legend(const MeshPicture& picture) {
    return shorter_side(picture) >= legend_from_size;
}

int fitting_height(const MeshPicture& picture, int least, int most) {
    Bounds bounds;
    for (const glm::dvec3& v : picture.vertices) bounds.add(v);
    const glm::dvec2 size = glm::dvec2(bounds.size()) * picture.metres_per_unit;
    if (!(size.x > 0 && size.y > 0))
        throw planet::Error(planet::Fault::bad_data, "a picture of a mesh", "all vertices lie on a line");
    MeshPicture fitting = picture;
    for (fitting.height = least; fitting.height < most; ++fitting.height) {
        const PixelBox plot = plot_of(fitting, shorter_side(fitting) / figure_size);
        if (static_cast<double>(plot.bottom - plot.top) * size.x >=
            static_cast<double>(plot.right - plot.left) * size.y)
            break;
    }
    return fitting.height;
}

MeshView make_mesh_view(const MeshPicture& picture) {
    MeshView view;
    view.planet = picture.planet;
    const double unit = shorter_side(picture) / figure_size;
    view.legend_unit = std::max(unit, least_legend_unit);
    view.line_unit = std::max(std::cbrt(unit), 0.8);
    view.plot = plot_of(picture, unit);
    view.middle = {0.5 * (view.plot.left + view.plot.right), 0.5 * (view.plot.top + view.plot.bottom)};
    glm::dmat3 turned(1);
    if (picture.planet) {
        turned = planet_rotation(picture.look_from);
    } else {
        turned[0].x = picture.metres_per_unit.x / picture.metres_per_unit.y;  // proportions only: the scale follows
        turned[1].y = -1;
    }
    // Large coordinates: the first vertex is subtracted before anything is multiplied.
    const glm::dvec3 base = picture.planet ? glm::dvec3(0) : picture.vertices[0];
    Bounds bounds;
    for (const glm::dvec3& v : picture.vertices) bounds.add(turned * (v - base));
    const glm::dvec3 size = bounds.size();
    if (!(size.x > 0 && size.y > 0))
        throw planet::Error(planet::Fault::bad_data, "a picture of a mesh", "all vertices lie on a line");
    const glm::dvec2 room(view.plot.right - view.plot.left, view.plot.bottom - view.plot.top);
    double scale = std::min(room.x / size.x, room.y / size.y);
    view.center = base + glm::inverse(turned) * glm::dvec3(glm::dvec2(bounds.center()), 0);
    if (picture.window) {
        const double across = picture.window->radius * (picture.planet ? 1 : turned[0].x);
        if (!(across > least_window * std::max(size.x, size.y)) || !std::isfinite(across))
            throw planet::Error(planet::Fault::bad_usage, "a picture of a mesh",
                                "a window of radius " + std::to_string(picture.window->radius),
                                "more than 1e-9 of the mesh");
        scale = 0.5 * std::min(room.x, room.y) / across;
        view.center = picture.window->center;
    }
    view.picture_from_mesh = scale * turned;
    if (!picture.planet) view.picture_from_mesh[2].z = 0;  // heights do not show in a plan
    view.places.reserve(picture.vertices.size());
    for (const glm::dvec3& v : picture.vertices) view.places.push_back(view.place(v));
    return view;
}

}  // namespace render
