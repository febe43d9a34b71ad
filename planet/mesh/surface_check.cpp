#include "planet/mesh/surface_check.h"

#include <algorithm>
#include <tuple>

#include "planet/mesh/mesh_sides.h"

namespace planet {

namespace {

std::size_t count_doubled(std::vector<glm::dvec3> vertices) {
    const auto key = [](const glm::dvec3& v) { return std::tie(v.x, v.y, v.z); };
    std::sort(vertices.begin(), vertices.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    std::size_t doubled = 0;
    for (std::size_t i = 1; i < vertices.size(); ++i) doubled += vertices[i] == vertices[i - 1];
    return doubled;
}

}  // namespace

SurfaceCheck check(const SurfaceMesh& mesh, MeshFrame frame) {
    SurfaceCheck c;
    c.vertices = mesh.vertices.size();
    c.triangles = mesh.triangles.size();
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& t : mesh.triangles) {
        c.degenerate += is_degenerate(t);
        for (const auto i : t) used[i] = true;
        const glm::dvec3 &p = mesh.vertices[t[0]], &q = mesh.vertices[t[1]], &r = mesh.vertices[t[2]];
        const glm::dvec3 normal = glm::cross(q - p, r - p);
        c.turned += !((frame == MeshFrame::ecef ? glm::dot(normal, p + q + r) : normal.z) > 0);
    }
    c.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    const SideCounts sides = count_sides(mesh.triangles);
    c.sides = sides.sides;
    c.border_sides = sides.border;
    c.wrong_sides = sides.wrong;
    c.doubled_vertices = count_doubled(mesh.vertices);
    c.strips_match = strips_match(mesh.strip, mesh.triangles);
    return c;
}

std::string SurfaceCheck::summary() const {
    std::string s;
    const auto add = [&s](std::size_t n, const char* what) {
        if (n != 0) s += (s.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    };
    add(wrong_sides, "wrong sides");
    add(doubled_vertices, "doubled vertices");
    add(degenerate, "degenerate triangles");
    add(unused_vertices, "unused vertices");
    add(turned, "turned triangles");
    if (!strips_match) s += (s.empty() ? "" : ", ") + std::string("strips differ");
    return s.empty() ? "sound" : s;
}

}  // namespace planet
