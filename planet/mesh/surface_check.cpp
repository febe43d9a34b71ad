#include "planet/mesh/surface_check.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace planet {

namespace {

using TriangleIndices = std::array<std::uint32_t, 3>;

struct SideCounts {
    std::size_t sides = 0;
    std::size_t border = 0;  // sides of one triangle only
    std::size_t wrong = 0;   // sides of more than two, or of two that run the same way: not a surface
};

bool is_degenerate(const TriangleIndices& t) {
    return t[0] == t[1] || t[1] == t[2] || t[0] == t[2];
}

// Sorts them: O(n log n).
SideCounts count_sides(std::span<const TriangleIndices> triangles) {
    // Each side as (low vertex, high vertex, direction): sorted, a sound inner side is the pair direction 0, direction 1.
    std::vector<std::uint64_t> directed;
    directed.reserve(triangles.size() * 3);
    for (const auto& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint64_t a = t[i], b = t[(i + 1) % 3];
            directed.push_back(a < b ? a << 32 | b << 1 : b << 32 | a << 1 | 1);
        }
    std::sort(directed.begin(), directed.end());
    SideCounts counts;
    for (std::size_t i = 0; i < directed.size();) {
        std::size_t j = i;
        while (j < directed.size() && directed[j] >> 1 == directed[i] >> 1) ++j;
        ++counts.sides;
        if (j - i == 1)
            ++counts.border;
        else if (j - i != 2 || directed[i] == directed[i + 1])
            ++counts.wrong;
        i = j;
    }
    return counts;
}

// Whether the strips draw exactly the triangles, same winding, same order.
bool strips_match(std::span<const std::uint32_t> strips, std::span<const TriangleIndices> triangles) {
    const auto from_least = [](TriangleIndices t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    std::size_t next = 0, start = 0;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        if (strips[i] == strip_restart) start = i + 1;
        if (i < start + 2) continue;
        TriangleIndices t{strips[i - 2], strips[i - 1], strips[i]};
        if (is_degenerate(t)) continue;
        if ((i - start) % 2 == 1) std::swap(t[0], t[1]);
        if (next == triangles.size() || from_least(t) != from_least(triangles[next])) return false;
        ++next;
    }
    return next == triangles.size();
}

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

SurfaceCheck check(const TriangleMesh& mesh) {
    SurfaceMesh surface;
    surface.vertices.reserve(mesh.vertices.size());
    for (const GridPosition& v : mesh.vertices) surface.vertices.push_back(ecef_from_grid(v));  // exact
    surface.triangles = mesh.triangles;
    surface.strip = mesh.strip;
    return check(surface, MeshFrame::ecef);
}

std::string SurfaceCheck::summary() const {
    if (closed()) return "closed";
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
    if (!s.empty()) return s;
    return "sound, " + std::to_string(border_sides) + " border sides, V - E + F = " + std::to_string(euler());
}

}  // namespace planet
