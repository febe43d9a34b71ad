#include "planet/tin/void_border.h"

#include <algorithm>

namespace planet {

namespace {

using Index = Delaunay::Index;

// Of a square that a diagonal from its only void corner divides: the half that is not void. `e` is that diagonal.
bool half_square(const Delaunay& mesh, const HeightGrid& grid, Index e, std::array<Index, 3>& half) {
    const Index f = mesh.twin(e);
    if (f == Delaunay::none) return false;
    const Index hole = mesh.origin(e), across = mesh.origin(f), left = mesh.origin(Delaunay::previous(e)),
                right = mesh.origin(Delaunay::previous(f));
    const glm::ivec2 diagonal = glm::abs(mesh.point(across) - mesh.point(hole));
    const auto valid = [&](Index v) { return grid.valid(mesh.point(v)); };
    if (diagonal != glm::ivec2(1, 1) || valid(hole) || !valid(across) || !valid(left) || !valid(right)) return false;
    const glm::ivec2 other = glm::abs(mesh.point(left) - mesh.point(right));
    half = {right, across, left};
    return other == glm::ivec2(1, 1);
}

}  // namespace

bool on_void_border(const HeightGrid& grid, glm::ivec2 sample) {
    const bool valid = grid.valid(sample);
    for (int y = std::max(0, sample.y - 1); y <= std::min(grid.height() - 1, sample.y + 1); ++y)
        for (int x = std::max(0, sample.x - 1); x <= std::min(grid.width() - 1, sample.x + 1); ++x)
            if (grid.valid({x, y}) != valid) return true;
    return false;
}

std::vector<glm::ivec2> void_border(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high) {
    std::vector<glm::ivec2> samples;
    if (!grid.has_void()) return samples;
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
            if (on_void_border(grid, {x, y})) samples.emplace_back(x, y);
    return samples;
}

namespace {

// Each once.
std::vector<std::array<glm::ivec2, 2>> constrained_sides(const Delaunay& mesh, glm::ivec2 offset) {
    std::vector<std::array<glm::ivec2, 2>> sides;
    for (Index t = 0; mesh.has_constraints() && t < mesh.triangle_slots(); ++t) {
        if (!mesh.alive(t)) continue;
        for (Index e = 3 * t; e < 3 * t + 3; ++e)
            if (mesh.constrained(e) && (mesh.twin(e) == Delaunay::none || e < mesh.twin(e)))
                sides.push_back(
                    {mesh.point(mesh.origin(e)) + offset, mesh.point(mesh.origin(Delaunay::next(e))) + offset});
    }
    return sides;
}

}  // namespace

TinMesh triangles_over_samples(const Delaunay& mesh, const HeightGrid& grid, glm::ivec2 offset) {
    TinMesh out;
    out.triangles.reserve(mesh.triangle_count());
    std::vector<std::uint8_t> used(mesh.vertex_slots(), 0);
    const auto add = [&](const std::array<Index, 3>& t) {
        out.triangles.push_back(t);
        for (const Index v : t) used[v] = 1;
    };
    for (Index t = 0; t < mesh.triangle_slots(); ++t) {
        if (!mesh.alive(t)) continue;
        const auto c = mesh.corners(t);
        if (!grid.has_void() || (grid.valid(c[0]) && grid.valid(c[1]) && grid.valid(c[2]))) {
            add(mesh.vertices(t));
            continue;
        }
        std::array<Index, 3> half;
        for (Index e = 3 * t; e < 3 * t + 3; ++e)
            if (half_square(mesh, grid, e, half)) add(half);
    }
    std::vector<Index> number(mesh.vertex_slots());
    out.vertices.reserve(mesh.vertex_count());
    out.height.reserve(mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_slots(); ++v) {
        if (!used[v]) continue;
        number[v] = static_cast<Index>(out.vertices.size());
        out.vertices.push_back(mesh.point(v) + offset);
        out.height.push_back(grid.at(mesh.point(v)));
    }
    for (auto& t : out.triangles)
        for (Index& v : t) v = number[v];
    out.held_sides = constrained_sides(mesh, offset);
    return out;
}

}  // namespace planet
