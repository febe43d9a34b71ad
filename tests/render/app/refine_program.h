#pragma once
// Runs `octaglobe refine` as a user does, on small meshes.

#include "planet/exporters/conforming.h"
#include "tests/render/app/command_report.h"
#include "tests/render/app/terrain_files.h"

namespace render {

inline void write_mesh_file(const std::filesystem::path& path, const planet::SurfaceMesh& mesh,
                            const planet::MeshReference& reference = {}, const planet::MeshLooks& looks = {}) {
    std::ofstream out(path, std::ios::binary);
    planet::write_mesh([&](std::string_view block) { out << block; }, mesh, reference,
                       planet::mesh_format(path.string()), std::nullopt, looks);
}

/// Squares of 100 m, each halved by a diagonal, with some relief: no two sides of a triangle are equally long.
inline planet::SurfaceMesh uneven_mesh(std::uint32_t n = 4) {
    planet::SurfaceMesh mesh;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            mesh.vertices.emplace_back(100 * x + 7 * std::sin(x + 3.0 * y), 100 * y + 9 * std::cos(2.0 * x + y),
                                       20 * std::sin(x * y + 1.0));
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t a = y * (n + 1) + x, c = a + n + 1;
            mesh.triangles.push_back({a, a + 1, c});
            mesh.triangles.push_back({a + 1, c + 1, c});
        }
    return mesh;
}

/// A rectangle over hilly_terrain(), in degrees.
inline planet::SurfaceMesh terrain_rectangle() {
    planet::SurfaceMesh mesh;
    mesh.vertices = {{10, 49.68, 0}, {10.4, 49.68, 0}, {10.4, 50, 0}, {10, 50, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline planet::MeshReference degrees_reference() {
    planet::MeshReference reference;
    reference.crs = "EPSG:4326";
    reference.geographic = true;
    return reference;
}

class RefineCommandTest : public CommandTest {
  protected:
    /// octaglobe refine ARGUMENTS; its report.
    Json refine(const std::string& arguments) { return report_of("refine " + arguments); }
    planet::SurfaceMesh read(const std::string& name, planet::MeshLooks* looks = nullptr) const {
        planet::SurfaceMesh mesh = planet::read_mesh((folder_.path() / name).string(), nullptr, looks);
        EXPECT_EQ(planet::conforming_fault(mesh), std::nullopt) << name;
        return mesh;
    }
};

inline double longest_side(const planet::SurfaceMesh& mesh) {
    double longest = 0;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(longest, glm::distance(mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]]));
    return longest;
}

}  // namespace render
