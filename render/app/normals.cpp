#include "render/app/normals.h"

namespace render {
namespace {

glm::vec3 unit(const glm::dvec3& v, const glm::vec3& otherwise) {
    const double length = glm::length(v);
    return length > 0 ? glm::vec3(v / length) : otherwise;
}

}  // namespace

std::vector<glm::vec3> normals_of(const planet::SurfaceMesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0));
    for (const auto& [a, b, c] : mesh.triangles) {
        const glm::dvec3 n = glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
        for (const auto v : {a, b, c}) sums[v] += n;
    }
    std::vector<glm::vec3> normals;
    normals.reserve(sums.size());
    for (const glm::dvec3& sum : sums) normals.push_back(unit(sum, {0, 0, 1}));
    return normals;
}

std::vector<glm::vec3> ground_normals(const planet::HeightGrid& grid, const planet::RasterFrame& frame,
                                      const std::vector<glm::ivec2>& samples) {
    constexpr glm::ivec2 ways[]{{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    std::vector<glm::dvec2> at;
    std::vector<double> heights;
    for (const glm::ivec2 p : samples)
        for (const glm::ivec2 way : ways) {
            glm::ivec2 q = p;
            for (int i = 0; i < ground_reach && grid.inside(q + way) && grid.valid(q + way); ++i) q += way;
            at.emplace_back(q);
            heights.push_back(static_cast<double>(grid.at(q)));
        }
    std::vector<glm::dvec3> placed(at.size());
    std::vector<glm::vec3> up(at.size());
    frame.place(at, heights, placed, up);
    std::vector<glm::vec3> normals;
    for (std::size_t i = 0; i < placed.size(); i += 4) {
        const glm::dvec3 n = glm::cross(placed[i] - placed[i + 1], placed[i + 2] - placed[i + 3]);
        normals.push_back(unit(glm::dot(n, glm::dvec3(up[i])) < 0 ? -n : n, up[i]));
    }
    return normals;
}

}  // namespace render
