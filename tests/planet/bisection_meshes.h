#pragma once
// Meshes for the tests of bisection, and what holds of them, worked out from vertices and triangles alone.

#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <random>
#include <set>

#include "planet/bisection/bisection.h"
#include "planet/bisection/shape.h"
#include "planet/tin/delaunay.h"

namespace planet {

/// A triangle with AB = 1 and C = (x, y).
inline PlainMesh one_triangle(double x, double y) {
    return {{{0, 0, 0}, {1, 0, 0}, {x, y, 0}}, {{0, 1, 2}}};
}

/// C in the region in which AB is the longest side and BC the shortest: all shapes of triangles, smallest angle at least 0.001.
inline glm::dvec2 random_apex(std::mt19937& random) {
    std::uniform_real_distribution<double> x(0.5, 1), y(0, 0.87);
    for (;;) {
        const glm::dvec2 c(x(random), y(random));
        if (dot(c, c) <= 1 && std::atan2(c.y, c.x) > 0.001) return c;
    }
}

/// A Delaunay mesh of random points of a square, with heights.
inline PlainMesh random_mesh(int points, unsigned seed, double relief = 100) {
    std::mt19937 random(seed);
    Delaunay mesh({0, 0}, {1 << 20, 1 << 20});
    for (int i = 0; i < points; ++i)
        mesh.insert({static_cast<int>(random() % (1 << 20)), static_cast<int>(random() % (1 << 20))});
    PlainMesh out;
    for (Delaunay::Index v = 0; v < mesh.vertex_slots(); ++v)
        out.vertices.emplace_back(mesh.point(v).x, mesh.point(v).y, relief * static_cast<double>(random() % 1000));
    for (Delaunay::Index t = 0; t < mesh.triangle_slots(); ++t)
        if (mesh.alive(t)) out.triangles.push_back(mesh.vertices(t));
    return out;
}

/// A grid of squares, each halved: right isosceles triangles, every length a tie. Height 0.
inline PlainMesh halved_squares(int columns, int rows, double step = 1, glm::dvec2 origin = {0, 0}) {
    PlainMesh out;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) out.vertices.emplace_back(origin.x + x * step, origin.y + y * step, 0);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x);
            const auto b = a + 1, d = a + static_cast<std::uint32_t>(columns) + 1, c = d + 1;
            out.triangles.push_back({a, b, c});
            out.triangles.push_back({a, c, d});
        }
    return out;
}

/// Equilateral triangles about a point, as far as doubles have them.
inline PlainMesh hexagon() {
    PlainMesh out{{{0, 0, 0}}, {}};
    for (int i = 0; i < 6; ++i) out.vertices.emplace_back(std::cos(i * M_PI / 3), std::sin(i * M_PI / 3), 0);
    for (std::uint32_t i = 0; i < 6; ++i) out.triangles.push_back({0, 1 + i, 1 + (i + 1) % 6});
    return out;
}

/// The octahedron: closed, all triangles equilateral, lengths equal to the last bit.
inline PlainMesh octahedron() {
    PlainMesh out{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {}};
    for (std::uint32_t i = 0; i < 4; ++i) {
        out.triangles.push_back({i, (i + 1) % 4, 4});
        out.triangles.push_back({(i + 1) % 4, i, 5});
    }
    return out;
}

/// A tetrahedron with random corners: a free surface without border.
inline PlainMesh tetrahedron(unsigned seed) {
    std::mt19937 random(seed);
    PlainMesh out{{}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    std::uniform_real_distribution<double> in(-1, 1);
    for (int i = 0; i < 4; ++i) out.vertices.emplace_back(in(random), in(random), in(random));
    return out;
}

/// Empty if a refinement of a base mesh is conforming: every directed side belongs to one triangle, and sides without a
/// partner lie on sides of the base that have none. Else what is wrong.
inline std::string conforming(const PlainMesh& mesh, const PlainMesh& base) {
    using SideKey = std::pair<std::uint32_t, std::uint32_t>;
    const auto border = [](const PlainMesh& m, std::vector<SideKey>& out) {
        std::set<SideKey> sides;
        for (const auto& t : m.triangles)
            for (std::size_t k = 0; k < 3; ++k)
                if (!sides.insert({t[k], t[(k + 1) % 3]}).second) return false;
        for (const SideKey& s : sides)
            if (!sides.contains({s.second, s.first})) out.push_back(s);
        return true;
    };
    std::vector<SideKey> open, base_open;
    if (!border(mesh, open)) return "a side belongs to two triangles of one orientation";
    border(base, base_open);
    const auto total = [](const PlainMesh& m, const std::vector<SideKey>& sides) {
        double sum = 0;
        for (const auto& [a, b] : sides) sum += length(m.vertices[b] - m.vertices[a]);
        return sum;
    };
    const double length_now = total(mesh, open), length_base = total(base, base_open);
    if (std::abs(length_now - length_base) > 1e-9 * (1 + length_base)) return "the border has another length";
    return {};
}

inline double area(const PlainMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
        sum += length(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]])) / 2;
    return sum;
}

inline double angle_of(const PlainMesh& mesh, const std::array<std::uint32_t, 3>& t) {
    return smallest_angle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

/// The places of all vertices, sorted.
inline std::vector<std::array<double, 3>> sorted_places(const PlainMesh& mesh) {
    std::vector<std::array<double, 3>> out;
    for (const glm::dvec3& p : mesh.vertices) out.push_back({p.x, p.y, p.z});
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace planet
