#pragma once
// Rasters for the tests of TINs, and what a TIN of them achieves, by brute force.

#include <cmath>
#include <map>
#include <random>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Hills in whole metres, rough at all scales.
inline HeightGrid rough_grid(int width, int height, unsigned seed = 1) {
    HeightGrid grid(width, height);
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double hills =
                300 * std::sin(x * 0.05) * std::cos(y * 0.04 + x * 0.02) + 60 * std::sin(x * 0.3 + y * 0.21);
            grid.set({x, y}, static_cast<float>(std::round(hills + static_cast<double>(random() % 20))));
        }
    return {grid, {0, 0}, {width - 1, height - 1}};
}

/// The same in millimetres.
inline HeightGrid fractional_grid(int width, int height, unsigned seed = 1) {
    HeightGrid grid = rough_grid(width, height, seed);
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) grid.set({x, y}, grid.at({x, y}) + static_cast<float>(random() % 1000) / 1000);
    return grid;
}

struct BruteDeviation {
    double max = 0;
    std::size_t uncovered = 0;  ///< valid samples in no triangle
    std::size_t voids = 0;      ///< void samples in one, its sides included
};

inline BruteDeviation brute_deviation(const TinMesh& mesh, const HeightGrid& grid) {
    BruteDeviation out;
    std::vector<std::uint8_t> covered(grid.count(), 0);
    for (const auto& t : mesh.triangles) {
        const glm::ivec2 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
        const glm::ivec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) {
                const glm::ivec2 p(x, y);
                const std::int64_t u = orientation(b, c, p), v = orientation(c, a, p), w = orientation(a, b, p);
                if (u < 0 || v < 0 || w < 0) continue;
                out.voids += !grid.valid(p);
                covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width()) +
                        static_cast<std::size_t>(x)] = 1;
                const double sum = static_cast<double>(u) * static_cast<double>(mesh.height[t[0]]) +
                                   static_cast<double>(v) * static_cast<double>(mesh.height[t[1]]) +
                                   static_cast<double>(w) * static_cast<double>(mesh.height[t[2]]);
                const double scale = static_cast<double>(u + v + w);
                if (grid.valid(p))
                    out.max = std::max(out.max, std::abs(sum - static_cast<double>(grid.at(p)) * scale) / scale);
            }
    }
    for (int y = 0; y < grid.height(); ++y)
        for (int x = 0; x < grid.width(); ++x)
            out.uncovered +=
                grid.valid({x, y}) && !covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width()) +
                                               static_cast<std::size_t>(x)];
    return out;
}

/// Whether every triangle turns left, every vertex is used and at a place of its own, and no side has more than two
/// triangles or two in the same direction. @param border_sides set to the number of sides of one triangle
inline bool sound(const TinMesh& mesh, std::size_t* border_sides = nullptr) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    std::map<std::pair<int, int>, int> places;
    std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
    for (const glm::ivec2 p : mesh.vertices)
        if (++places[{p.x, p.y}] > 1) return false;
    for (const auto& t : mesh.triangles) {
        if (orientation(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]) <= 0) return false;
        for (std::size_t k = 0; k < 3; ++k) {
            used[t[k]] = 1;
            if (++sides[{t[k], t[(k + 1) % 3]}] > 1) return false;
        }
    }
    std::size_t single = 0;
    for (const auto& [side, count] : sides) single += !sides.contains({side.second, side.first});
    if (border_sides) *border_sides = single;
    return std::find(used.begin(), used.end(), 0) == used.end();
}

/// Twice the area of all triangles.
inline std::int64_t doubled_area(const TinMesh& mesh) {
    std::int64_t area = 0;
    for (const auto& t : mesh.triangles)
        area += orientation(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    return area;
}

}  // namespace planet
