// Merging domains: their sizes by the paper's proposition 3.1, that an algorithm visits them and nothing else, and that
// they are those of a graph of triangles that knows no codes.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "planet/quadtree/patch_lattice.h"
#include "triangle_graph.h"

namespace planet {
namespace {

using testing::full_mesh;
using testing::graph_triangle;
using testing::TriangleGraph;

template <class Set>
class MergingDomain : public ::testing::Test {};
using Sets = ::testing::Types<DenseSplitSet, SparseSplitSet>;
TYPED_TEST_SUITE(MergingDomain, Sets);

/// A vertex of a label near the middle of 3 x 3 patches.
glm::ivec2 vertex_in_the_middle(const PatchLattice& lattice, int label) {
    const int middle = 3 * lattice.patch_size() / 2, k = (label - 1) / 2, step = lattice.patch_size() >> (k + 1);
    if (label % 2 == 1) return k == 0 ? glm::ivec2(middle) : glm::ivec2(middle + step);
    return k == 0 ? glm::ivec2(lattice.patch_size(), middle) : glm::ivec2(middle, middle + step);
}

TEST(MergingDomain, SizesOfThePaper) {
    const std::uint64_t sizes[] = {2, 6, 14, 30, 54, 94, 150, 238, 358, 542, 790, 1166};
    for (int i = 1; i <= 12; ++i) EXPECT_EQ(merging_domain_size(i), sizes[i - 1]) << i;
    EXPECT_STREQ(vertex_grid(1), "cartesian");
    EXPECT_STREQ(vertex_grid(2), "quincunx");
}

// i spreading steps from labels 1 to 4: cartesian, quincunx, and the same again in the next smaller square.
TYPED_TEST(MergingDomain, IsAsLargeAsProposition31Says) {
    for (int i = 1; i <= 20; ++i)
        for (int label = 1; label <= 4 && i + label <= 22; ++label) {
            const int levels = i + label - 1;
            auto t = full_mesh<TypeParam>(PatchGrid(3, 3), levels);
            const PatchLattice lattice(t.topology(), (levels + 1) / 2);
            const CellCode cell = *lattice.cell_split_at(vertex_in_the_middle(lattice, label));
            ASSERT_EQ(vertex_label(cell, t.topology().root_bits()), label);
            ASSERT_EQ(t.remove(cell), merging_domain_size(i)) << i << " " << vertex_grid(label);
            if (i <= 12) {
                ASSERT_FALSE(t.check());
            }
        }
}

TYPED_TEST(MergingDomain, GrowsByStepsAndTakesVerticesAlong) {
    const std::vector<int> by_step{2, 4, 8, 16, 24, 40, 56, 88};
    const std::size_t removed_vertices[] = {1, 5, 17, 49, 125};
    for (int label = 1; label <= 2; ++label)
        for (int i = 1; i <= 8; ++i) {
            auto t = full_mesh<TypeParam>(PatchGrid(3, 3), i + label - 1);
            const PatchLattice lattice(t.topology(), (t.levels() + 1) / 2);
            const std::size_t before = t.split_cells().count();
            std::vector<int> found;
            t.remove(*lattice.cell_split_at(vertex_in_the_middle(lattice, label)), [&](CellCode, int step) {
                found.resize(static_cast<std::size_t>(step));
                ++found.back();
            });
            EXPECT_EQ(found, std::vector<int>(by_step.begin(), by_step.begin() + i));
            // No vertex of the domain lies on a border, and so each splits two cells.
            if (i <= 5) {
                EXPECT_EQ((before - t.split_cells().count()) / 2, removed_vertices[i - 1]);
            }
        }
}

// The paper's figure 7.
TYPED_TEST(MergingDomain, OfTheCentreOfNinePatchesReachesAllNeighbors) {
    auto t = full_mesh<TypeParam>(PatchGrid(3, 3), 8);
    const auto leaves_in = [&](int column, int row) {
        int leaves = 0;
        for (const int half : {0, 1}) {
            const auto count = [&](const auto& self, CellCode c) -> void {
                if (!t.is_split(c))
                    ++leaves;
                else
                    self(self, c << 1), self(self, c << 1 | 1);
            };
            count(count, t.topology().root_of_patch(column, row, half));
        }
        return leaves;
    };
    EXPECT_EQ(leaves_in(0, 0), 512);
    EXPECT_EQ(t.remove(t.topology().root_of_patch(1, 1, 0)), 238u);
    EXPECT_EQ(leaves_in(1, 1), 2);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            if (row == 1 && column == 1) continue;
            EXPECT_LT(leaves_in(column, row), 512) << column << " " << row;
            EXPECT_GT(leaves_in(column, row), 2) << column << " " << row;
        }
    EXPECT_FALSE(t.check());
    EXPECT_EQ(testing::conformity_fault(t), "");
}

/// Counts what the algorithm asks for, under its nose.
struct CountingGrid : PatchGrid {
    CountingGrid(int columns, int rows, std::size_t& calls) : PatchGrid(columns, rows), calls_(&calls) {}
    CellCode neighbor(CellCode cell) const {
        ++*calls_;
        return PatchGrid::neighbor(cell);
    }
    std::size_t* calls_;
};
std::multiset<CellCode> dropped_cells;
template <class Set>
struct CountingSet : Set {
    using Set::Set;
    unsigned drop(CellCode cell) {
        dropped_cells.insert(cell);
        return Set::drop(cell);
    }
};

TYPED_TEST(MergingDomain, IsVisitedOnceAndNothingElseIs) {
    for (const int levels : {1, 4, 8, 11, 14}) {
        std::size_t calls = 0;
        auto t = full_mesh<CountingSet<TypeParam>>(CountingGrid(3, 3, calls), levels);
        dropped_cells.clear();
        std::vector<std::size_t> by_step;
        const std::size_t visited = t.remove(t.topology().root_of_patch(1, 1, 1), [&](CellCode, int step) {
            by_step.resize(static_cast<std::size_t>(step));
            ++by_step.back();
        });
        EXPECT_EQ(visited, merging_domain_size(levels));
        EXPECT_EQ(dropped_cells.size(), visited);
        EXPECT_EQ(std::set<CellCode>(dropped_cells.begin(), dropped_cells.end()).size(), visited);
        // One neighbour for the vertex itself, and one for each child of a merged cell of all steps but the last.
        EXPECT_EQ(calls, 1 + 2 * (visited - by_step.back()));
    }
}

struct Domains {
    double mean;
    std::size_t largest;
};

/// Removes each vertex of the full mesh for itself, and compares its merging domain with the graph's, cell by cell.
template <class Set, Topology Topo, class Choose>
Domains compare_with_graph(const Topo& topology, int levels, Choose&& choose) {
    const auto full = full_mesh<Set>(topology, levels);
    TriangleGraph graph(topology, levels);
    std::size_t sum = 0, largest = 0, vertices = 0;
    std::set<int> seen;
    for (int rank = 0; rank < topology.root_count(); ++rank)
        full.for_each_split_below(topology.root(rank), [&](CellCode cell) {
            const int v = graph.split_vertex(graph_triangle(graph, topology, cell));
            if (!choose(graph.vertices()[static_cast<std::size_t>(v)].at, graph.size()) || !seen.insert(v).second)
                return;
            graph.set_all(true);
            auto t = full;
            std::vector<int> merged;
            const std::size_t visited =
                t.remove(cell, [&](CellCode c, int) { merged.push_back(graph_triangle(graph, topology, c)); });
            std::sort(merged.begin(), merged.end());
            EXPECT_EQ(merged, graph.remove(v));
            EXPECT_EQ(visited, merged.size());
            sum += visited;
            largest = std::max(largest, visited);
            ++vertices;
        });
    return {static_cast<double>(sum) / static_cast<double>(vertices), largest};
}
constexpr auto every_vertex = [](const testing::LatticePoint&, std::int64_t) { return true; };

// Spreads are cut short at the border: the centre of a patch merges but its two halves.
TYPED_TEST(MergingDomain, OfEveryVertexOfASinglePatch) {
    const double means[] = {1.2, 2.571, 4.545, 6.870, 9.053, 10.782};
    for (int d = 1; d <= 6; ++d) {
        EXPECT_NEAR(compare_with_graph<TypeParam>(PatchGrid(1, 1), 2 * d, every_vertex).mean, means[d - 1], 5e-4) << d;
        auto t = full_mesh<TypeParam>(PatchGrid(1, 1), 2 * d);
        EXPECT_EQ(t.remove(t.topology().root(0)), 2u);
        EXPECT_EQ(t.split_cells().count(), 0u);
    }
}

TYPED_TEST(MergingDomain, OfEveryVertexOfGridsOfPatches) {
    for (const auto& [columns, rows, levels] : {std::tuple{3, 3, 6}, {2, 3, 7}, {5, 1, 5}, {1, 2, 8}})
        compare_with_graph<TypeParam>(PatchGrid(columns, rows), levels, every_vertex);
}

TYPED_TEST(MergingDomain, OfEveryVertexOfTheOctahedron) {
    const Domains level8 = compare_with_graph<TypeParam>(OctahedronTopology{}, 8, every_vertex);
    EXPECT_NEAR(level8.mean, 10.110, 5e-4);
    EXPECT_EQ(level8.largest, 104u);
    const Domains level10 = compare_with_graph<TypeParam>(OctahedronTopology{}, 10, every_vertex);
    EXPECT_NEAR(level10.mean, 11.717, 5e-4);
    EXPECT_EQ(level10.largest, 240u);
}

TYPED_TEST(MergingDomain, NearCornersAndSidesOfTheOctahedronsFaces) {
    for (const int levels : {13, 14}) {
        int corners = 0, sides = 0;
        compare_with_graph<TypeParam>(
            OctahedronTopology{}, levels, [&](const testing::LatticePoint& p, std::int64_t size) {
                const auto a = glm::abs(p);
                const std::int64_t most = std::max({a.x, a.y, a.z}), least = std::min({a.x, a.y, a.z});
                const bool corner = most > size - size / 16, side = least <= 1 && (p.x + p.y + p.z) % 3 == 0;
                corners += corner;
                sides += side;
                return corner || side;
            });
        EXPECT_GT(corners, 6 * 16);
        EXPECT_GT(sides, 12 * 16);
    }
}

}  // namespace
}  // namespace planet
