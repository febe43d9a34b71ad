// Codes of a square patch against the Sierpinski bitree, triangle by triangle to level 13; and what each costs to keep.

#include "sierpinski_bitree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "planet/quadtree/dense_quadtree.h"
#include "planet/quadtree/patch_lattice.h"
#include "planet/quadtree/triangulation.h"

namespace planet {
namespace {

using testing::SierpinskiBitree;
using Position = SierpinskiBitree::Position;

constexpr int last_level = 13;
constexpr int n = 7;  // 2 n >= 13

/// Every triangle with its code, from the roots: visit(level, position, code).
template <class Visit>
void for_each(const SierpinskiBitree& tree, Visit&& visit) {
    const auto walk = [&](const auto& self, int level, Position p, CellCode code) -> void {
        visit(level, p, code);
        if (level == last_level) return;
        self(self, level + 1, tree.at(level, p).left, code << 1);
        self(self, level + 1, tree.at(level, p).right, code << 1 | 1);
    };
    walk(walk, 0, {0, 0}, 2);
    walk(walk, 0, {0, 1}, 3);
}

TEST(SierpinskiBitree, HasEveryTriangleOnce) {
    const SierpinskiBitree tree(n);
    std::vector<std::vector<CellCode>> seen;
    for (int level = 0; level <= last_level; ++level) {
        EXPECT_EQ(tree.rows(level) * tree.columns(level), 2 << level);
        seen.emplace_back(std::size_t{2} << level);
    }
    std::size_t count = 0;
    for_each(tree, [&](int level, Position p, CellCode code) {
        auto& place =
            seen[static_cast<std::size_t>(level)][static_cast<std::size_t>(p.row * tree.columns(level) + p.column)];
        EXPECT_EQ(place, 0u) << level;
        place = code;
        ++count;
    });
    EXPECT_EQ(count, (std::size_t{4} << last_level) - 2);
}

TEST(SierpinskiBitree, AgreesWithCodesOnCornersTypesAndParents) {
    const SierpinskiBitree tree(n);
    const PatchLattice lattice(PatchGrid(1, 1), n);
    for_each(tree, [&](int level, Position p, CellCode code) {
        const LatticeCorners c = lattice.corners(code);
        const auto v = tree.vertices(level, p);
        // Cells of even levels run counter-clockwise from left to right to apex, those of odd ones clockwise.
        ASSERT_EQ(level % 2 == 0 ? c.left : c.right, v[0]) << level << " " << code;
        ASSERT_EQ(level % 2 == 0 ? c.right : c.left, v[1]) << level << " " << code;
        ASSERT_EQ(c.apex, v[2]) << level << " " << code;
        // Eight orientations: four of the split side at even levels, four at odd ones.
        ASSERT_EQ(tree.at(level, p).type < SierpinskiBitree::west, level % 2 == 0);
        const glm::ivec2 way = glm::sign(c.right - c.left);
        const auto type_of_way = [&]() -> unsigned {
            if (way == glm::ivec2(1, 1)) return SierpinskiBitree::north_west;
            if (way == glm::ivec2(-1, -1)) return SierpinskiBitree::south_east;
            if (way == glm::ivec2(-1, 1)) return SierpinskiBitree::south_west;
            if (way == glm::ivec2(1, -1)) return SierpinskiBitree::north_east;
            if (way == glm::ivec2(0, 1)) return SierpinskiBitree::west;
            if (way == glm::ivec2(1, 0)) return SierpinskiBitree::north;
            return way == glm::ivec2(-1, 0) ? SierpinskiBitree::south : SierpinskiBitree::east;
        };
        ASSERT_EQ(tree.at(level, p).type, type_of_way());
        if (level == last_level) return;
        for (const Position child : {tree.at(level, p).left, tree.at(level, p).right})
            ASSERT_EQ(tree.at(level + 1, child).parent, p) << level;
    });
}

TEST(SierpinskiBitree, AgreesWithCodesOnNeighbors) {
    const SierpinskiBitree tree(n);
    const PatchGrid patch(1, 1);
    std::vector<std::vector<CellCode>> codes;
    for (int level = 0; level <= last_level; ++level) codes.emplace_back(std::size_t{2} << level);
    const auto code_at = [&](int level, std::optional<Position> p) -> CellCode& {
        static CellCode none = 0;
        if (!p) return none;
        return codes[static_cast<std::size_t>(level)]
                    [static_cast<std::size_t>(p->row * tree.columns(level) + p->column)];
    };
    for_each(tree, [&](int level, Position p, CellCode code) { code_at(level, p) = code; });
    std::size_t borders = 0;
    for_each(tree, [&](int level, Position p, CellCode code) {
        ASSERT_EQ(patch.neighbor(code), code_at(level, tree.neighbor(3, level, p))) << level << " " << code;
        for (const int i : {1, 2}) {
            const auto across = tree.neighbor(i, level, p);
            borders += !across;
            // Vertex 1 is left at even levels, right at odd ones, and its neighbour lies across the other leg.
            const Side leg = (i == 1) == (level % 2 == 0) ? Side::right_leg : Side::left_leg;
            if (level == 0) {
                ASSERT_FALSE(across);
                continue;
            }
            ASSERT_EQ(leg_neighbor(patch, code, leg), code_at(level, across)) << level << " " << code << " " << i;
        }
    });
    // Legs lie on the border at even levels only, 2^(level / 2) on each of the four sides.
    EXPECT_EQ(borders, 4u * ((1u << (last_level / 2 + 1)) - 1));
}

TEST(SierpinskiBitree, AgreesWithCodesOnTheOrderOfTheCurve) {
    const SierpinskiBitree tree(n);
    for (int level = 0; level <= last_level; ++level) {
        Triangulation<PatchGrid, DenseSplitSet> t(PatchGrid(1, 1), level);
        if (level > 0)
            for (const CellCode root : {2u, 3u}) t.split_cells().fill(root);
        std::vector<std::array<glm::ivec2, 3>> along;
        for (const std::uint16_t half : {std::uint16_t{0}, std::uint16_t{1}})
            tree.walk(0, {0, half}, level, [&](Position p) { along.push_back(tree.vertices(level, p)); });
        std::size_t i = 0;
        const PatchLattice lattice(t.topology(), n);
        t.for_each_leaf([&](CellCode code) {
            ASSERT_LT(i, along.size());
            ASSERT_EQ(lattice.corners(code).apex, along[i][2]);
            ASSERT_EQ(lattice.corners(code).left, along[i][level % 2]);
            ++i;
        });
        EXPECT_EQ(i, along.size());
    }
}

// What level 1 copied four-fold would give: the reason why level 3 is a pattern of its own.
TEST(SierpinskiBitree, LevelThreeIsNotFourCopiesOfLevelOne) {
    const SierpinskiBitree tree(n);
    EXPECT_EQ(tree.at(3, {0, 0}).type, tree.at(1, {0, 0}).type);
    EXPECT_NE(tree.at(3, {0, 2}).type, tree.at(1, {0, 0}).type);
    EXPECT_EQ(tree.at(5, {0, 4}).type, tree.at(3, {0, 0}).type);
}

/// A circle over a patch of 2^d + 1 samples a side, refined to its samples.
Triangulation<PatchGrid, SparseSplitSet> circle(int d) {
    Triangulation<PatchGrid, SparseSplitSet> t(PatchGrid(1, 1), 2 * d);
    const PatchLattice lattice(t.topology(), d);
    for (int k = 0; k < 8 << d; ++k) {
        const double angle = 2 * std::numbers::pi * k / (8 << d);
        const glm::ivec2 at = glm::dvec2(0.5 + 0.4 * std::cos(angle), 0.5 + 0.4 * std::sin(angle)) * std::ldexp(1, d);
        if (const auto cell = lattice.cell_split_at(at | 1)) t.split(*cell);
    }
    return t;
}

double megabytes(double bytes) {
    return bytes / 1e6;
}
double megabytes(const SparseSplitSet& set) {
    return megabytes(static_cast<double>(set.bytes()));
}
/// A binary tree of nodes with two 32-bit links, leaves included: an RTIN, whose labels give the rest.
double linked_tree_megabytes(std::size_t split_cells) {
    return megabytes(8. * static_cast<double>(2 * split_cells + 2));
}

// The table of planet/README.md: every triangle of a patch of 1,025 samples a side, a circle on it, and a circle on one
// of 65,537.
TEST(Memory, OfEachStructureIsAsStated) {
    constexpr int d = 10, deep_d = 16;
    const auto triangles = [](int levels) { return std::ldexp(4, levels) - 2; };
    const auto adaptive = circle(d), deep = circle(deep_d);
    EXPECT_EQ(adaptive.split_cells().count(), 17'126u);
    EXPECT_EQ(deep.split_cells().count(), 1'119'998u);

    const SierpinskiBitree tree(d);
    double kept = 0;
    for (int level = 0; level <= tree.last_level(); ++level) kept += tree.rows(level) * tree.columns(level);
    EXPECT_EQ(kept, triangles(2 * d));
    EXPECT_EQ(SierpinskiBitree::bytes_of_triangle, 13.125);
    EXPECT_EQ(sizeof(SierpinskiBitree::Triangle), 14u);  // 7 bits of it unused
    EXPECT_NEAR(megabytes(kept * SierpinskiBitree::bytes_of_triangle), 55.05, 0.005);
    EXPECT_NEAR(megabytes(triangles(2 * deep_d) * SierpinskiBitree::bytes_of_triangle), 225'500, 50);

    EXPECT_NEAR(linked_tree_megabytes((std::size_t{2} << (2 * d)) - 2), 33.55, 0.005);
    EXPECT_NEAR(linked_tree_megabytes(adaptive.split_cells().count()), 0.274, 5e-4);
    EXPECT_NEAR(linked_tree_megabytes(deep.split_cells().count()), 17.92, 0.005);

    const DenseQuadtree<float> deviations(1, 2, 2 * d);
    EXPECT_NEAR(megabytes(static_cast<double>(deviations.bytes())), 8.39, 0.005);
    EXPECT_NEAR(megabytes(4 * (triangles(2 * deep_d) / 2 - 1)), 34'360, 5);

    const DenseSplitSet dense(1, 2 * d);
    EXPECT_NEAR(megabytes(static_cast<double>(dense.bytes())), 0.262, 5e-4);
    EXPECT_NEAR(static_cast<double>(dense.bytes()) / triangles(2 * d), 0.0625, 1e-6);
    EXPECT_NEAR(megabytes(std::ldexp(1, 2 * deep_d + 1) / 8), 1'074, 1);

    SparseSplitSet full(1, 2 * d);
    for (const CellCode root : {2u, 3u}) full.fill(root);
    EXPECT_NEAR(megabytes(full), 1.31, 0.005);
    EXPECT_NEAR(megabytes(adaptive.split_cells()), 0.082, 5e-4);
    EXPECT_NEAR(megabytes(deep.split_cells()), 5.24, 0.005);
}

}  // namespace
}  // namespace planet
