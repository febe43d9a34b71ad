// Codes of a square patch against the Sierpinski bitree, triangle by triangle to level 13; and what each costs to keep.

#include "sierpinski_bitree.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace planet
