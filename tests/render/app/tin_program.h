#pragma once
// Runs `octaglobe tin` as a user does, for the tests of its parts.

#include <set>
#include <tuple>

#include "tests/render/app/command_report.h"
#include "tests/render/app/terrain_files.h"

namespace render {

class TinCommandTest : public CommandTest {
  protected:
    /// octaglobe tin ARGUMENTS; its report.
    Json tin(const std::string& arguments) { return report_of("tin " + arguments); }
};

/// Sides of one triangle only; fails where one has more than two, or two that turn against each other.
inline std::size_t open_sides(const planet::SurfaceMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_TRUE(sides.insert({t[k], t[(k + 1) % 3]}).second) << "a side twice the same way";
    std::size_t open = 0;
    for (const auto& [a, b] : sides) open += !sides.contains({b, a});
    return open;
}

/// One mesh of several: vertices at the same place, to the bit, become one.
inline planet::SurfaceMesh put_together(const std::vector<planet::SurfaceMesh>& parts) {
    planet::SurfaceMesh whole;
    std::map<std::tuple<double, double, double>, std::uint32_t> at;
    for (const planet::SurfaceMesh& part : parts)
        for (auto t : part.triangles) {
            for (auto& v : t) {
                const glm::dvec3 p = part.vertices[v];
                const auto [place, fresh] =
                    at.insert({{p.x, p.y, p.z}, static_cast<std::uint32_t>(whole.vertices.size())});
                if (fresh) whole.vertices.push_back(p);
                v = place->second;
            }
            whole.triangles.push_back(t);
        }
    return whole;
}

/// 6 x the volume within a closed mesh whose triangles turn left seen from outside.
inline double sixfold_volume(const planet::SurfaceMesh& mesh) {
    double volume = 0;
    const glm::dvec3 middle = mesh.vertices[0];
    for (const auto& [a, b, c] : mesh.triangles)
        volume += glm::dot(mesh.vertices[a] - middle, glm::cross(mesh.vertices[b] - middle, mesh.vertices[c] - middle));
    return volume;
}

}  // namespace render
