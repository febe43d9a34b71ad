#include "planet/quadtree/patch_lattice.h"

#include <algorithm>
#include <array>
#include <bit>

#include "planet/octahedron/octahedron_map.h"

namespace planet {

namespace {

int cross(glm::ivec2 a, glm::ivec2 b) {
    return a.x * b.y - a.y * b.x;
}

}  // namespace

std::optional<CellCode> PatchLattice::cell_split_at(glm::ivec2 vertex) const {
    const int size = patch_size();
    if (vertex.x < 0 || vertex.y < 0 || vertex.x >= width() || vertex.y >= height()) return std::nullopt;
    if (vertex.x % size == 0 && vertex.y % size == 0) return std::nullopt;
    const glm::ivec2 patch = glm::min(vertex / size, glm::ivec2(grid_.columns(), grid_.rows()) - 1);
    const glm::ivec2 in = vertex - patch * size;
    CellCode cell = grid_.root_of_patch(patch.x, patch.y, in.y >= in.x ? 0 : 1);
    LatticeCorners c = root_corners(cell);
    bool counter_clockwise = true;
    while (split_vertex(c) != vertex) {
        // The median from apex to split vertex parts the children, child 0 on the left of a counter-clockwise cell: cells
        // of even levels. On the median either will do.
        const glm::ivec2 m = split_vertex(c);
        const int side = cross(c.apex - m, vertex - m);
        const unsigned i = (counter_clockwise ? side : -side) >= 0 ? 0 : 1;
        counter_clockwise = !counter_clockwise;
        cell = cell << 1 | i;
        c = child(c, i);
    }
    return cell;
}

OctahedronVertex nearest_vertex(const glm::dvec3& normal, int bisection_level) {
    const LocationCode cell = cell_at(normal, bisection_level);
    // On the way down, the cell that each corner splits; a root's corners split none.
    std::array<CellCode, 3> splits{};
    for (int level = 0; level < bisection_level; ++level) {
        const CellCode above = cell.ancestor(level).bits();
        const auto [left, right, apex] = splits;
        splits = cell.ancestor(level + 1).child_index() == 0 ? std::array{left, apex, above}
                                                             : std::array{apex, right, above};
    }
    const Corners c = corners(cell);
    const std::array<glm::dvec3, 3> at{c.left, c.right, c.apex};
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (glm::dot(at[k], normal) > glm::dot(at[best], normal)) best = k;
    return {splits[best], at[best]};
}

}  // namespace planet
