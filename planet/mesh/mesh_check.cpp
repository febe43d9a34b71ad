#include "planet/mesh/mesh_check.h"

#include <algorithm>
#include <tuple>

namespace planet {

namespace {

std::size_t count_open_sides(const TriangleMesh& mesh, std::size_t& sides) {
    // Each side as (low vertex, high vertex, direction): sorted, a sound side is the pair direction 0, direction 1.
    std::vector<std::uint64_t> directed;
    directed.reserve(mesh.triangles.size() * 3);
    for (const auto& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint64_t a = t[i], b = t[(i + 1) % 3];
            directed.push_back(a < b ? a << 32 | b << 1 : b << 32 | a << 1 | 1);
        }
    std::sort(directed.begin(), directed.end());
    std::size_t open = 0;
    sides = 0;
    for (std::size_t i = 0; i < directed.size();) {
        std::size_t j = i;
        while (j < directed.size() && directed[j] >> 1 == directed[i] >> 1) ++j;
        ++sides;
        if (j - i != 2 || directed[i] == directed[i + 1]) ++open;
        i = j;
    }
    return open;
}

std::size_t count_doubled_vertices(const TriangleMesh& mesh) {
    std::vector<GridPosition> v = mesh.vertices;
    const auto key = [](const GridPosition& g) { return std::tie(g.x, g.y, g.z, g.low); };
    std::sort(v.begin(), v.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    std::size_t doubled = 0;
    for (std::size_t i = 1; i < v.size(); ++i) doubled += v[i] == v[i - 1];
    return doubled;
}

bool strip_matches(const TriangleMesh& mesh) {
    std::size_t next = 0;
    for (std::size_t i = 0; i + 2 < mesh.strip.size(); ++i) {
        std::array<std::uint32_t, 3> t{mesh.strip[i], mesh.strip[i + 1], mesh.strip[i + 2]};
        if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
        if (i & 1) std::swap(t[0], t[1]);
        if (next == mesh.triangles.size()) return false;
        auto want = mesh.triangles[next++];
        std::rotate(want.begin(), std::min_element(want.begin(), want.end()), want.end());
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        if (t != want) return false;
    }
    return next == mesh.triangles.size();
}

}  // namespace

MeshCheck check(const TriangleMesh& mesh) {
    MeshCheck c;
    c.vertices = mesh.vertices.size();
    c.triangles = mesh.triangles.size();
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& t : mesh.triangles) {
        if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) ++c.degenerate;
        for (const auto i : t) used[i] = true;
        const glm::dvec3 p = ecef_from_grid(mesh.vertices[t[0]]), q = ecef_from_grid(mesh.vertices[t[1]]),
                         r = ecef_from_grid(mesh.vertices[t[2]]);
        if (glm::dot(glm::cross(q - p, r - p), p + q + r) <= 0) ++c.inward;
    }
    c.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    c.open_sides = count_open_sides(mesh, c.sides);
    c.doubled_vertices = count_doubled_vertices(mesh);
    c.strip_matches = strip_matches(mesh);
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
