#pragma once
// The lattice under a grid of patches: where the corners of a cell lie, and which cell a vertex splits.

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "planet/quadtree/topology.h"

namespace planet {

/// The corners of a cell, in samples. x to the right, y up (topology.h).
struct LatticeCorners {
    glm::ivec2 left, right, apex;
};

/// Patches of 2^quadtree_levels + 1 samples a side; neighbours share the samples on their border.
class PatchLattice {
  public:
    /// @param quadtree_levels 0..28. Sides of the whole lattice must stay below 2^30 samples.
    PatchLattice(PatchGrid grid, int quadtree_levels) : grid_(grid), quadtree_levels_(quadtree_levels) {
        assert(quadtree_levels >= 0 && quadtree_levels <= 28);
        assert((std::int64_t{std::max(grid.columns(), grid.rows())} << quadtree_levels) < (1 << 30));
    }

    const PatchGrid& grid() const { return grid_; }
    int quadtree_levels() const { return quadtree_levels_; }
    /// Bisection levels of unit cells, the finest: half a unit square each.
    int bisection_levels() const { return 2 * quadtree_levels_; }
    /// Steps along a patch's side.
    int patch_size() const { return 1 << quadtree_levels_; }
    int width() const { return (grid_.columns() << quadtree_levels_) + 1; }  ///< samples
    int height() const { return (grid_.rows() << quadtree_levels_) + 1; }    ///< samples

    LatticeCorners root_corners(CellCode root) const {
        const auto number = static_cast<int>(root & ((CellCode{1} << grid_.root_bits()) - 1));
        const int size = patch_size();
        const glm::ivec2 sw = glm::ivec2(number / 2 % grid_.columns(), number / 2 / grid_.columns()) * size;
        const glm::ivec2 ne = sw + size;
        if ((number & 1) == 0) return {sw, ne, {sw.x, ne.y}};
        return {ne, sw, {ne.x, sw.y}};
    }
    static LatticeCorners child(const LatticeCorners& c, unsigned i) {
        const glm::ivec2 m = split_vertex(c);
        return i == 0 ? LatticeCorners{c.left, c.apex, m} : LatticeCorners{c.apex, c.right, m};
    }
    /// Of a cell that is no unit cell.
    static glm::ivec2 split_vertex(const LatticeCorners& c) { return (c.left + c.right) / 2; }

    /// @param cell of a level up to bisection_levels()
    LatticeCorners corners(CellCode cell) const {
        const int level = bisection_level_of(cell, grid_.root_bits());
        LatticeCorners c = root_corners(cell >> level);
        for (int i = level - 1; i >= 0; --i) c = child(c, cell >> i & 1);
        return c;
    }

    /// A cell that the vertex splits, or std::nullopt for a corner of a patch, which nothing splits, and for a place
    /// outside the lattice.
    std::optional<CellCode> cell_split_at(glm::ivec2 vertex) const;

  private:
    PatchGrid grid_;
    int quadtree_levels_;
};

/// A vertex of the mesh of a bisection level on the octahedron.
struct OctahedronVertex {
    CellCode cell;      ///< a cell that it splits; 0 for the six corners of the octahedron
    glm::dvec3 normal;  ///< unit geodetic normal
};

/// The vertex nearest to a direction, among the corners of the cell that holds it. @param bisection_level 0..60
OctahedronVertex nearest_vertex(const glm::dvec3& normal, int bisection_level);

/// The label of a vertex: the step of the subdivision process that inserts it, 1 for the split vertex of a root.
inline int vertex_label(CellCode split_cell, int root_bits) {
    return bisection_level_of(split_cell, root_bits) + 1;
}
/// Odd labels lie on the cartesian grid of the paper, even ones on the quincunx grid.
inline const char* vertex_grid(int label) {
    return label % 2 == 1 ? "cartesian" : "quincunx";
}

/// Triangles that merge when a vertex is removed from a full triangulation without borders: m(i) of the paper's
/// proposition 3.1, whose equation (17) is right where (2) and (3) are misprinted. @param i spreading steps, 1..60:
/// 1 for the finest vertices, one more for each label less
constexpr std::uint64_t merging_domain_size(int i) {
    if (i <= 4) return (std::uint64_t{2} << i) - 2;
    const int f = (i - 4) / 2;
    return 16 * ((std::uint64_t{2} << (i - f - 4)) + (std::uint64_t{3} << f)) - 8 * static_cast<unsigned>(i) - 18;
}

}  // namespace planet
