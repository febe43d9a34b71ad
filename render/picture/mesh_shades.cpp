// Light from the upper left, for the roundness of a planet and for relief.

#include <algorithm>
#include <cmath>

#include "render/picture/mesh_figure.h"

namespace render {
namespace {

const glm::dvec3 light = glm::normalize(glm::dvec3(-0.55, -0.6, 0.75));  ///< right, down, towards the viewer
constexpr double wanted_slope = 0.4;                                     ///< root mean square after exaggeration
constexpr double most_exaggeration = 30;                                 ///< beyond, roundings would show as hills
constexpr double darkest = 0.25, brightest = 1.3;

/// By vertex: the slope of the surface, rise by run, along right and down and towards the viewer. Area-weighted normals.
std::vector<glm::dvec3> vertex_slopes(const MeshPicture& picture, const glm::dmat3& turned) {
    std::vector<glm::dvec3> slopes(picture.vertices.size(), glm::dvec3(0));
    const glm::dvec3 metres = picture.planet ? glm::dvec3(1) : glm::dvec3(picture.metres_per_unit, 1);
    for (const auto& t : picture.triangles) {
        const glm::dvec3& a = picture.vertices[t[0]];
        glm::dvec3 n = glm::cross(metres * (picture.vertices[t[1]] - a), metres * (picture.vertices[t[2]] - a));
        if (!picture.planet && n.z < 0) n = -n;
        for (const std::uint32_t v : t) slopes[v] += n;
    }
    for (std::size_t v = 0; v < slopes.size(); ++v) {
        const glm::dvec3 up = picture.planet ? glm::normalize(picture.vertices[v]) : glm::dvec3(0, 0, 1);
        const double along = glm::dot(slopes[v], up);
        slopes[v] = along > 0 ? turned * (slopes[v] / along - up) : glm::dvec3(0);
    }
    return slopes;
}

double exaggeration(const std::vector<glm::dvec3>& slopes) {
    double sum = 0;
    for (const glm::dvec3& s : slopes) sum += glm::dot(s, s);
    const double mean = std::sqrt(sum / static_cast<double>(slopes.size()));
    return mean > 0 ? std::min(wanted_slope / mean, most_exaggeration) : 0;
}

}  // namespace

std::vector<float> vertex_shades(const MeshPicture& picture, const MeshView& view) {
    if (!picture.planet && !picture.relief) return {};
    // Rotation or mirror image only: rows of length 1.
    glm::dmat3 turned(1, 0, 0, 0, -1, 0, 0, 0, 1);
    if (picture.planet) turned = view.picture_from_mesh / glm::length(view.picture_from_mesh[0]);
    std::vector<glm::dvec3> slopes;
    double exaggerated = 0;
    if (picture.relief) {
        slopes = vertex_slopes(picture, turned);
        exaggerated = exaggeration(slopes);
    }
    std::vector<float> shades(picture.vertices.size());
    for (std::size_t v = 0; v < shades.size(); ++v) {
        const glm::dvec3 up = picture.planet ? turned * glm::normalize(picture.vertices[v]) : glm::dvec3(0, 0, 1);
        const double flat = glm::dot(up, light);
        double shade = picture.planet ? 0.5 + 0.52 * (0.5 + 0.5 * flat) : 1;
        if (picture.relief) shade += 0.9 * (glm::dot(glm::normalize(up + exaggerated * slopes[v]), light) - flat);
        shades[v] = static_cast<float>(std::clamp(shade, darkest, brightest));
    }
    return shades;
}

}  // namespace render
