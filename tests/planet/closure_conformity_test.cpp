// Split, merge and remove in any order: always conforming, always the least superset or the greatest subset, the same
// over dense and sparse sets.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "triangle_graph.h"

namespace planet {
namespace {

using testing::conformity_fault;
using testing::full_mesh;
using testing::graph_triangle;
using testing::TriangleGraph;

template <Topology Topo, class Set>
std::vector<CellCode> split_cells_of(const Triangulation<Topo, Set>& t) {
    std::vector<CellCode> cells;
    for (int rank = 0; rank < t.topology().root_count(); ++rank)
        t.for_each_split_below(t.topology().root(rank), [&](CellCode c) { cells.push_back(c); });
    return cells;
}

/// A triangulation and the graph that says what it should be.
template <Topology Topo, class Set>
class Walk {
  public:
    Walk(const Topo& topology, int levels, unsigned seed)
        : t_(topology, levels), graph_(topology, levels), random_(seed) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(topology.root_count()); ++i)
            list(CellCode{1} << topology.root_bits() | i, levels);
    }

    void step() {
        const CellCode cell = any_cell();
        const int v = vertex(cell);
        switch (random_() % 8) {
            case 0:
            case 1:
            case 2:
                split(cell, v);
                break;
            case 3:
            case 4:
                merge(cell, v);
                break;
            case 5:
                split_and_take_back(cell);
                break;
            default:
                remove(cell, v);
        }
    }
    void compare() {
        std::size_t present = 0;
        for (const CellCode cell : cells_) {
            ASSERT_EQ(t_.is_split(cell), graph_.is_present(vertex(cell))) << cell;
            present += t_.is_split(cell);
        }
        ASSERT_EQ(t_.split_cells().count(), present);
        ASSERT_FALSE(t_.check());
    }
    const Triangulation<Topo, Set>& triangulation() const { return t_; }
    std::size_t cell_count() const { return cells_.size(); }

  private:
    void list(CellCode cell, int levels) {
        if (levels == 0) return;
        cells_.push_back(cell);
        list(cell << 1, levels - 1);
        list(cell << 1 | 1, levels - 1);
    }
    // Removing a vertex near the roots takes most of the mesh along: not too often.
    CellCode any_cell() {
        const CellCode deep = cells_[random_() % cells_.size()];
        return random_() % 64 == 0 ? deep >> random_() % static_cast<unsigned>(t_.level_of(deep) + 1) : deep;
    }
    int vertex(CellCode cell) const { return graph_.split_vertex(graph_triangle(graph_, t_.topology(), cell)); }

    void split(CellCode cell, int v) {
        std::vector<int> added;
        const int count = t_.split(cell, [&](CellCode c, CellCode n) {
            added.push_back(vertex(c));
            ASSERT_TRUE(n == 0 || vertex(n) == vertex(c));
            // Parents first.
            for (const int p : graph_.vertices()[static_cast<std::size_t>(added.back())].parents)
                ASSERT_TRUE(graph_.is_present(p) || std::count(added.begin(), added.end(), p) == 1);
        });
        ASSERT_EQ(static_cast<std::size_t>(count), added.size());
        std::vector<int> least = graph_.refine(v);
        std::sort(added.begin(), added.end());
        std::sort(least.begin(), least.end());
        ASSERT_EQ(added, least);
    }
    void merge(CellCode cell, int v) {
        const bool can_go = graph_.can_go(v);
        ASSERT_EQ(t_.merge(cell), can_go);
        if (can_go) graph_.remove(v);
    }
    void remove(CellCode cell, int v) {
        std::vector<int> merged;
        const std::size_t visited =
            t_.remove(cell, [&](CellCode c, int) { merged.push_back(graph_triangle(graph_, t_.topology(), c)); });
        std::sort(merged.begin(), merged.end());
        ASSERT_EQ(visited, merged.size());
        ASSERT_EQ(merged, graph_.remove(v));
    }
    // The splits of a closure undone one by one, last first, and the last of them at once by its removal.
    void split_and_take_back(CellCode cell) {
        const auto before = split_cells_of(t_);
        std::vector<CellCode> order;
        t_.split(cell, [&](CellCode c, CellCode) { order.push_back(c); });
        if (!order.empty()) {
            ASSERT_EQ(t_.remove(cell), t_.topology().neighbor(cell) == 0 ? 1u : 2u);
            order.pop_back();
        }
        for (; !order.empty(); order.pop_back()) ASSERT_TRUE(t_.merge(order.back()));
        ASSERT_EQ(split_cells_of(t_), before);
    }

    Triangulation<Topo, Set> t_;
    TriangleGraph graph_;
    std::mt19937 random_;
    std::vector<CellCode> cells_;  ///< all that can be split
};

template <class Set, Topology Topo>
void walk(const Topo& topology, int levels, int steps) {
    Walk<Topo, Set> w(topology, levels, static_cast<unsigned>(levels));
    std::size_t sum = 0;
    for (int i = 0; i < steps; ++i) {
        w.step();
        if (i % 4 == 0) w.compare();
        if (i % 16 == 0) {
            ASSERT_EQ(conformity_fault(w.triangulation()), "") << i;
        }
        if (::testing::Test::HasFatalFailure()) FAIL() << "at step " << i;
        sum += w.triangulation().split_cells().count();
    }
    // Neither nearly empty nor nearly full on the way.
    const double share = static_cast<double>(sum) / steps / static_cast<double>(w.cell_count());
    if (levels > 2) {
        EXPECT_GT(share, 0.1);
        EXPECT_LT(share, 0.9);
    }
}

template <class Set>
class Closure : public ::testing::Test {};
using Sets = ::testing::Types<DenseSplitSet, SparseSplitSet>;
TYPED_TEST_SUITE(Closure, Sets);

// Levels that end chunks of six, and that do not.
TYPED_TEST(Closure, BothWaysInAnyOrderOnAPatch) {
    for (const int levels : {1, 2, 5, 6, 7, 9}) walk<TypeParam>(PatchGrid(1, 1), levels, 3000);
}
TYPED_TEST(Closure, BothWaysInAnyOrderOnPatches) {
    walk<TypeParam>(PatchGrid(3, 3), 6, 3000);
    walk<TypeParam>(PatchGrid(2, 3), 7, 3000);
    walk<TypeParam>(PatchGrid(1, 4), 8, 3000);
}
TYPED_TEST(Closure, BothWaysInAnyOrderOnTheOctahedron) {
    walk<TypeParam>(OctahedronTopology{}, 6, 3000);
    walk<TypeParam>(OctahedronTopology{}, 7, 3000);
    walk<TypeParam>(OctahedronTopology{}, 8, 3000);
}

/// Cells of all levels, half of them near the roots' borders.
template <Topology Topo>
CellCode random_cell(const Topo& topology, int levels, std::mt19937_64& random) {
    const int level = static_cast<int>(random() % static_cast<unsigned>(levels));
    const CellCode mask = (CellCode{1} << level) - 1, bits = random();
    const CellCode near_border = random() % 2 ? 0x5555555555555555u : 0xcccccccccccccccc;
    const CellCode path = random() % 2 ? bits : near_border ^ (bits >> (random() % 60));
    const int rank = static_cast<int>(random() % static_cast<unsigned>(topology.root_count()));
    return topology.root(rank) << level | (path & mask);
}

template <Topology Topo>
void walk_deep(const Topo& topology, int levels) {
    std::mt19937_64 random(1);
    Triangulation<Topo, SparseSplitSet> t(topology, levels);
    for (int i = 0; i < 600; ++i) {
        const CellCode cell = random_cell(topology, levels, random);
        t.split(cell);
        ASSERT_TRUE(t.is_split(cell));
        if (i % 32 == 0) {
            const auto cells = split_cells_of(t);
            const CellCode gone = cells[random() % cells.size()];
            ASSERT_GT(t.remove(gone), 0u);
            ASSERT_FALSE(t.is_split(gone));
        }
        if (i % 200 == 199) {
            ASSERT_FALSE(t.check());
            ASSERT_EQ(conformity_fault(t), "");
            ASSERT_EQ(t.split_cells().count(), split_cells_of(t).size());
        }
    }
}

// 58 levels: no graph can follow there, but coordinates still tell.
TEST(Closure, IsConformingDeepDown) {
    walk_deep(PatchGrid(1, 1), 56);
    walk_deep(PatchGrid(3, 2), 52);
    walk_deep(OctahedronTopology{}, 58);
}

template <Topology Topo>
void compare_sets(const Topo& topology, int levels) {
    std::mt19937_64 random(2);
    Triangulation<Topo, DenseSplitSet> dense(topology, levels);
    Triangulation<Topo, SparseSplitSet> sparse(topology, levels);
    for (int i = 0; i < 20000; ++i) {
        const CellCode cell = random_cell(topology, levels, random);
        std::vector<std::pair<CellCode, int>> by_dense, by_sparse;
        switch (random() % 16) {
            case 0:
                dense.remove(cell, [&](CellCode c, int step) { by_dense.emplace_back(c, step); });
                sparse.remove(cell, [&](CellCode c, int step) { by_sparse.emplace_back(c, step); });
                break;
            case 1:
                ASSERT_EQ(dense.merge(cell), sparse.merge(cell));
                break;
            default:
                dense.split(cell, [&](CellCode c, CellCode) { by_dense.emplace_back(c, 0); });
                sparse.split(cell, [&](CellCode c, CellCode) { by_sparse.emplace_back(c, 0); });
        }
        ASSERT_EQ(by_dense, by_sparse);
        if (i % 1000 == 0) {
            ASSERT_EQ(split_cells_of(dense), split_cells_of(sparse));
            ASSERT_EQ(dense.split_cells().count(), sparse.split_cells().count());
        }
    }
    EXPECT_GT(dense.split_cells().count(), 1000u);
}

TEST(Closure, OverDenseAndSparseSetsIsTheSame) {
    compare_sets(PatchGrid(1, 1), 20);
    compare_sets(PatchGrid(3, 3), 17);
    compare_sets(OctahedronTopology{}, 19);
}

TYPED_TEST(Closure, LeavesFollowTheCurve) {
    std::mt19937_64 random(3);
    Triangulation<OctahedronTopology, TypeParam> t({}, 14);
    for (int i = 0; i < 200; ++i) t.split(random_cell(t.topology(), 14, random));
    const auto leaves = testing::leaf_triangles(t);
    std::size_t count = 0;
    CellCode before = 0;
    t.for_each_leaf([&](CellCode c) {
        EXPECT_TRUE(t.is_leaf(c));
        EXPECT_FALSE(t.is_leaf(c << 1));
        if (count > 0) {  // consecutive leaves share a side: one is across a side of the other, or above that cell
            bool touch = false;
            for (const auto& [a, b] : {std::pair{c, before}, {before, c}}) {
                CellCode next[] = {t.topology().neighbor(a), 0, 0};
                if (t.level_of(a) > 0) {
                    next[1] = leg_neighbor(t.topology(), a, Side::left_leg);
                    next[2] = leg_neighbor(t.topology(), a, Side::right_leg);
                } else {
                    next[1] = neighbor(LocationCode(a), Side::left_leg).bits();
                    next[2] = neighbor(LocationCode(a), Side::right_leg).bits();
                }
                for (const CellCode n : next) touch = touch || n == b || n >> 1 == b;
            }
            EXPECT_TRUE(touch);
        }
        before = c;
        ++count;
    });
    EXPECT_EQ(count, leaves.size());
}

TYPED_TEST(Closure, CheckTellsWhatIsNotConforming) {
    auto t = full_mesh<TypeParam>(PatchGrid(2, 2), 8);
    EXPECT_FALSE(t.check());
    t.split_cells().drop(t.topology().root(3) << 4 | 6);
    EXPECT_TRUE(t.check());
    EXPECT_NE(conformity_fault(t), "");
    Triangulation<OctahedronTopology, TypeParam> half({}, 4);
    half.split_cells().insert(half.topology().root(0));
    EXPECT_EQ(half.check(), half.topology().root(0));
}

TYPED_TEST(Closure, SetsKnowTheirBounds) {
    for (const int levels : {0, 1, 5, 6, 7, 13}) {
        TypeParam set(3, levels);
        EXPECT_EQ(set.levels(), levels);
        EXPECT_FALSE(set.contains(0));
        EXPECT_FALSE(set.contains(CellCode{9} << levels));  // too deep
        EXPECT_EQ(set.count(), 0u);
        if (levels == 0) continue;
        EXPECT_TRUE(set.insert(9).is_new);
        EXPECT_FALSE(set.insert(9).is_new);
        for (int level = 1; level < levels; ++level) EXPECT_TRUE(set.insert(CellCode{9} << level).parent_split);
        EXPECT_EQ(set.count(), static_cast<std::size_t>(levels));
        EXPECT_EQ(set.drop(9), levels > 1 ? 1u : 0u);
        EXPECT_EQ(set.drop(9), 0u);
        EXPECT_EQ(set.count(), 0u);
        set.fill(11);
        EXPECT_EQ(set.count(), (std::size_t{1} << levels) - 1);
        EXPECT_FALSE(set.contains(CellCode{11} << levels));
        EXPECT_EQ(set.drop(11), levels > 1 ? 3u : 0u);
        EXPECT_EQ(set.count(), 0u);
    }
}

// Chunks in which nothing is split any more are used again.
TEST(SparseSplitSet, StaysSmallWhateverComesAndGoes) {
    std::mt19937_64 random(4);
    Triangulation<OctahedronTopology, SparseSplitSet> t({}, 40);
    std::size_t most = 0;
    for (int round = 0; round < 200; ++round) {
        for (int i = 0; i < 20; ++i) t.split(random_cell(t.topology(), 40, random));
        most = std::max(most, t.split_cells().bytes());
        for (int rank = 0; rank < face_count; ++rank) t.remove(t.topology().root(rank));
        ASSERT_EQ(t.split_cells().count(), 0u);
    }
    EXPECT_LE(most, std::size_t{1} << 17);
}

}  // namespace
}  // namespace planet
