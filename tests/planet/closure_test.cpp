// Closure on patches and the octahedron: sizes of merging domains, exactly, and conformity after any operation.

#include <gtest/gtest.h>

#include <numeric>

#include "planet/quadtree/patch_lattice.h"
#include "planet/quadtree/triangulation.h"

namespace planet {
namespace {

template <class Set>
Triangulation<PatchGrid, Set> full_patches(int columns, int rows, int quadtree_levels) {
    Triangulation<PatchGrid, Set> t(PatchGrid(columns, rows), 2 * quadtree_levels);
    for (int rank = 0; rank < t.topology().root_count(); ++rank) {
        if constexpr (std::is_same_v<Set, DenseSplitSet>) {
            if (quadtree_levels > 0) t.split_cells().fill(t.topology().root(rank));
        } else {
            for (int level = 0; level < 2 * quadtree_levels; ++level)
                for (CellCode c = t.topology().root(rank) << level; c < (t.topology().root(rank) + 1) << level; ++c)
                    t.split_cells().insert(c);
        }
    }
    return t;
}

TEST(Closure, CentreOfNinePatchesMerges238Cells) {
    auto t = full_patches<DenseSplitSet>(3, 3, 4);
    const PatchLattice lattice(t.topology(), 4);
    const CellCode centre = *lattice.cell_split_at({24, 24});
    EXPECT_EQ(vertex_label(centre, t.topology().root_bits()), 1);
    std::vector<std::size_t> by_step;
    const std::size_t visited = t.remove(centre, [&](CellCode, int step) {
        by_step.resize(static_cast<std::size_t>(step));
        ++by_step.back();
    });
    EXPECT_EQ(visited, 238u);
    EXPECT_EQ(by_step, (std::vector<std::size_t>{2, 4, 8, 16, 24, 40, 56, 88}));
    EXPECT_FALSE(t.check());
}

// Means over every vertex of a single patch.
TEST(Closure, SinglePatches) {
    const double means[] = {1.2, 2.571, 4.545, 6.870, 9.053, 10.782};
    for (int d = 1; d <= 6; ++d) {
        const auto full = full_patches<DenseSplitSet>(1, 1, d);
        const PatchLattice lattice(full.topology(), d);
        double sum = 0;
        int vertices = 0;
        for (int y = 0; y < lattice.height(); ++y)
            for (int x = 0; x < lattice.width(); ++x) {
                const auto cell = lattice.cell_split_at({x, y});
                if (!cell) continue;
                auto t = full;
                const std::size_t visited = t.remove(*cell);
                if (x == lattice.width() / 2 && y == x) {
                    EXPECT_EQ(visited, 2u);
                }
                sum += static_cast<double>(visited);
                ++vertices;
            }
        EXPECT_NEAR(sum / vertices, means[d - 1], 5e-4) << d;
    }
}

TEST(Closure, FormulaOfThePaper) {
    const std::uint64_t sizes[] = {2, 6, 14, 30, 54, 94, 150, 238, 358, 542, 790, 1166};
    for (int i = 1; i <= 12; ++i) EXPECT_EQ(merging_domain_size(i), sizes[i - 1]) << i;
}

}  // namespace
}  // namespace planet
