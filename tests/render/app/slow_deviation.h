#pragma once
// How far a written mesh is from the samples of its raster, found the slow way: for each sample every triangle is tried.
// Nothing here knows of lattices, patches or frames of the library.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "planet/exporters/mesh_file.h"
#include "tests/render/app/terrain_files.h"

namespace render {

struct SlowDeviation {
    double max = 0, rms = 0;
    std::size_t samples = 0, uncovered = 0;  ///< valid ones
};

/// Where a vertical line meets the plane of a triangle: the height over its foot, and how far inside the sides that is,
/// as a share of the triangle; negative outside.
struct Crossing {
    double height = 0, inside = -1;
};

inline Crossing crossing(const std::array<glm::dvec3, 3>& t, const glm::dvec3& foot, const glm::dvec3& up) {
    const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double across = glm::dot(up, n);
    // Beside a pole triangles have two corners at one place.
    const double longest = std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
    if (glm::length(n) < 1e-9 * longest * longest) return {};
    const double height = glm::dot(t[0] - foot, n) / across;
    const glm::dvec3 p = foot + height * up;
    const double area = glm::dot(n, n);
    double inside = 1;
    for (std::size_t k = 0; k < 3; ++k)
        inside = std::min(inside, glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), n) / area);
    return {height, inside};
}

/// @param place of (column, row): the foot of a sample's vertical, and its direction
/// @param slack how far outside a triangle its border still counts: chords cut what is curved
template <class Place>
SlowDeviation slow_deviation(const planet::SurfaceMesh& mesh, const Terrain& terrain, double slack, Place&& place) {
    SlowDeviation out;
    for (int row = 0; row < terrain.height; ++row)
        for (int column = 0; column < terrain.width; ++column) {
            const double h = static_cast<double>(static_cast<float>(terrain.height_m(column, row)));
            if (!std::isfinite(h)) continue;
            const auto [foot, up] = place(column, row);
            Crossing best;
            for (const auto& t : mesh.triangles) {
                const Crossing c = crossing({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, foot, up);
                // Not the far side of a planet.
                if (c.inside > best.inside && std::abs(c.height) < 1e6) best = c;
            }
            ++out.samples;
            if (best.inside < -slack) {
                ++out.uncovered;
                continue;
            }
            out.max = std::max(out.max, std::abs(best.height - h));
            out.rms += (best.height - h) * (best.height - h);
        }
    out.rms = std::sqrt(out.rms / static_cast<double>(out.samples - out.uncovered));
    return out;
}

/// In the raster's own coordinates.
inline SlowDeviation slow_deviation_in_source(const planet::SurfaceMesh& mesh, const Terrain& terrain) {
    return slow_deviation(mesh, terrain, 1e-6, [&](int column, int row) {
        return std::pair(glm::dvec3(terrain.x + column * terrain.step_x, terrain.y + row * terrain.step_y, 0),
                         glm::dvec3(0, 0, 1));
    });
}

/// The foot and the normal on WGS84: Torge and Müller, "Geodesy" (2012), equation 4.27.
inline std::pair<glm::dvec3, glm::dvec3> foot_and_normal(double longitude_degrees, double latitude_degrees) {
    const double lon = longitude_degrees * std::numbers::pi / 180, lat = latitude_degrees * std::numbers::pi / 180;
    constexpr double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double radius = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
    const glm::dvec3 n(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat));
    return {glm::dvec3(radius * n.x, radius * n.y, radius * (1 - e2) * n.z), n};
}

/// Of a mesh in ecef, or in enu with the origin and axes that its file tells, of a raster in longitude and latitude whose
/// heights are above the ellipsoid.
inline SlowDeviation slow_deviation_in_space(planet::SurfaceMesh mesh, const planet::MeshReference& reference,
                                             const Terrain& terrain) {
    if (reference.frame == planet::MeshFrame::enu)
        for (glm::dvec3& v : mesh.vertices) v = reference.origin + reference.ecef_from_enu * v;
    return slow_deviation(mesh, terrain, 0.05, [&](int column, int row) {
        return foot_and_normal(terrain.x + column * terrain.step_x, terrain.y + row * terrain.step_y);
    });
}

/// What a command reports of a mesh of a terrain above the ellipsoid is what is found the slow way.
/// @param reference of the frame: an .stl does not tell its own
inline void expect_as_reported(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference,
                               const Terrain& terrain, const nlohmann::json& report) {
    const bool source = report.at("frame") == "source";
    const SlowDeviation slow =
        source ? slow_deviation_in_source(mesh, terrain) : slow_deviation_in_space(mesh, reference, terrain);
    EXPECT_EQ(slow.uncovered, 0u);
    EXPECT_EQ(slow.samples, report.at("samples"));
    // In space a sample on a side may lie over either triangle.
    EXPECT_NEAR(slow.max, report.at("deviation_max_m").get<double>(), source ? 1e-6 : 0.05);
    EXPECT_NEAR(slow.rms, report.at("deviation_rms_m").get<double>(), source ? 1e-6 : 0.01);
}

}  // namespace render
