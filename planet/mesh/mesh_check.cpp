#include "planet/mesh/mesh_check.h"

#include <algorithm>
#include <tuple>

#include "planet/mesh/mesh_sides.h"

namespace planet {

namespace {

std::size_t count_doubled_vertices(const TriangleMesh& mesh) {
    std::vector<GridPosition> v = mesh.vertices;
    const auto key = [](const GridPosition& g) { return std::tie(g.x, g.y, g.z, g.low); };
    std::sort(v.begin(), v.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    std::size_t doubled = 0;
    for (std::size_t i = 1; i < v.size(); ++i) doubled += v[i] == v[i - 1];
    return doubled;
}

}  // namespace

MeshCheck check(const TriangleMesh& mesh) {
    MeshCheck c;
    c.vertices = mesh.vertices.size();
    c.triangles = mesh.triangles.size();
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& t : mesh.triangles) {
        c.degenerate += is_degenerate(t);
        for (const auto i : t) used[i] = true;
        const glm::dvec3 p = ecef_from_grid(mesh.vertices[t[0]]), q = ecef_from_grid(mesh.vertices[t[1]]),
                         r = ecef_from_grid(mesh.vertices[t[2]]);
        if (glm::dot(glm::cross(q - p, r - p), p + q + r) <= 0) ++c.inward;
    }
    c.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    const SideCounts sides = count_sides(mesh.triangles);
    c.sides = sides.sides;
    c.open_sides = sides.border + sides.wrong;
    c.doubled_vertices = count_doubled_vertices(mesh);
    c.strip_matches = strips_match(mesh.strip, mesh.triangles);
    return c;
}

std::string MeshCheck::summary() const {
    if (ok()) return "closed";
    std::string s;
    const auto add = [&s](std::size_t n, const char* what) {
        if (n != 0) s += (s.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    };
    add(open_sides, "open sides");
    add(doubled_vertices, "doubled vertices");
    add(degenerate, "degenerate triangles");
    add(unused_vertices, "unused vertices");
    add(inward, "inward triangles");
    if (!strip_matches) s += (s.empty() ? "" : ", ") + std::string("strip differs");
    if (euler() != 2) s += (s.empty() ? "" : ", ") + std::string("V-E+F = ") + std::to_string(euler());
    return s;
}

}  // namespace planet
