#include "planet/octahedron/cell_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "planet/octahedron/octahedron_map.h"

namespace planet {

namespace {

constexpr int measured_levels = 16;

void measure(const Corners& c, int level, std::array<CellMetrics, max_bisection_level + 1>& table) {
    CellMetrics& m = table[static_cast<std::size_t>(level)];
    const double split = glm::distance(c.left, c.right), l = glm::distance(c.left, c.apex),
                 r = glm::distance(c.apex, c.right);
    const double area = 0.5 * glm::length(glm::cross(c.left - c.apex, c.right - c.apex));
    const auto angle = [](double opposite, double p, double q) {
        return std::acos(std::clamp((p * p + q * q - opposite * opposite) / (2 * p * q), -1.0, 1.0));
    };
    m.split_min = std::min(m.split_min, split);
    m.split_max = std::max(m.split_max, split);
    m.side_min = std::min({m.side_min, split, l, r});
    m.side_max = std::max({m.side_max, split, l, r});
    m.area_min = std::min(m.area_min, area);
    m.area_max = std::max(m.area_max, area);
    m.angle_min = std::min({m.angle_min, angle(split, l, r), angle(l, split, r), angle(r, split, l)});
    if (level + 1 == measured_levels) return;
    const glm::dvec3 mid = split_vertex(c);
    for (int i = 0; i < 2; ++i) measure(child_corners(c, mid, i), level + 1, table);
}

std::array<CellMetrics, max_bisection_level + 1> make() {
    std::array<CellMetrics, max_bisection_level + 1> table;
    for (int level = 0; level <= max_bisection_level; ++level) {
        const double vertices = 2 + 4 * std::exp2(level);  // V - E + F = 2 with 8 * 2^level triangles
        table[static_cast<std::size_t>(level)] = {9, 0, 9, 0, 9, 0, 9, std::sqrt(4 * std::numbers::pi / vertices)};
    }
    measure(face_corners(0), 0, table);  // all faces are images of one
    for (std::size_t level = measured_levels; level < table.size(); ++level) {
        const double spacing = table[level].vertex_spacing;
        CellMetrics m = table[level - 2];
        for (double* length : {&m.split_min, &m.split_max, &m.side_min, &m.side_max}) *length *= 0.5;
        m.area_min *= 0.25;
        m.area_max *= 0.25;
        m.vertex_spacing = spacing;
        table[level] = m;
    }
    return table;
}

}  // namespace

const CellMetrics& cell_metrics(int bisection_level) {
    static const auto table = make();
    return table[static_cast<std::size_t>(bisection_level)];
}

int level_for_spacing(double spacing_m, double radius_m) {
    int level = 0;
    while (level < max_bisection_level && cell_metrics(level).vertex_spacing * radius_m > spacing_m) ++level;
    return level;
}

}  // namespace planet
