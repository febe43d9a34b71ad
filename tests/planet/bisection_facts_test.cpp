// What the paper and its sources say of longest-side bisection: steps, propagation, shapes, ties, the quadtree.

#include <gtest/gtest.h>

#include "bisection_meshes.h"
#include "planet/bisection/progressive.h"
#include "planet/elevation/raster_io.h"
#include "planet/patches/least_mesh.h"
#include "planet/tin/make_tin.h"

namespace planet {
namespace {

using Index = Bisection::Index;

constexpr double modified_bound = 0.673408;
constexpr BisectionRule rules[] = {BisectionRule::modified, BisectionRule::plain};

TEST(BisectionFacts, AfterTwoStepsBothRulesHaveTheSameVertices) {
    std::vector<PlainMesh> bases = {halved_squares(3, 2), hexagon(), octahedron(), tetrahedron(1)};
    for (unsigned seed = 0; seed < 20; ++seed) bases.push_back(random_mesh(30, seed, 0));
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec2 c = random_apex(random);
        bases.push_back(one_triangle(c.x, c.y));
    }
    for (const PlainMesh& base : bases) {
        Bisection modified(base, {BisectionRule::modified}), plain(base, {BisectionRule::plain});
        for (int step = 0; step < 2; ++step) {
            modified.step();
            plain.step();
        }
        EXPECT_TRUE(sorted_places(modified.mesh()) == sorted_places(plain.mesh()));
        EXPECT_EQ(modified.triangle_count(), plain.triangle_count());
        EXPECT_EQ(modified.check(), "");
    }
}

TEST(BisectionFacts, TwoStepsMakeFourSimilarTrianglesWhereTheConditionHolds) {
    std::mt19937 random(2);
    int fours = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec2 c = random_apex(random);
        const PlainMesh base = one_triangle(c.x, c.y);
        const SquaredSides sides = {1, dot(c - glm::dvec2(1, 0), c - glm::dvec2(1, 0)), dot(c, c)};
        const double median2 = dot(c - glm::dvec2(0.5, 0), c - glm::dvec2(0.5, 0));
        Bisection mesh(base);
        mesh.step();
        const bool pending = mesh.report().pending_triangles == 2;
        EXPECT_EQ(pending, sides[1] >= median2 && median2 >= 0.25);
        if (!pending) continue;
        ++fours;
        mesh.step();
        const BisectionReport r = mesh.report();
        EXPECT_EQ(r.triangles, 4u);
        EXPECT_EQ(r.pending_triangles, 0u);
        EXPECT_EQ(r.similarity_classes, 1u);
        EXPECT_NEAR(r.angle_ratio_min, 1, 1e-9);
    }
    EXPECT_GT(fours, 300);
}

TEST(BisectionFacts, SplittingTheSecondLongestSideGivesThreeTrianglesAndSparesTheShortest) {
    std::mt19937 random(3);
    for (const BisectionRule rule : rules)
        for (int i = 0; i < 500; ++i) {
            const glm::dvec2 c = random_apex(random);
            Bisection mesh(one_triangle(c.x, c.y), {rule});
            // Side 0 is AB, 1 is BC, the shortest, 2 is CA.
            EXPECT_EQ(mesh.split_side({0, 2}), 2u);
            EXPECT_EQ(mesh.triangle_count(), 3u);
            bool shortest_whole = false;
            for (Index t = 0; t < 3; ++t)
                for (int k = 0; k < 3; ++k) {
                    const auto corners = mesh.corners(t);
                    shortest_whole |= corners[static_cast<std::size_t>(k)] == 1 &&
                                      corners[static_cast<std::size_t>((k + 1) % 3)] == 2;
                }
            EXPECT_TRUE(shortest_whole);
            EXPECT_EQ(mesh.report().propagation_max, 1u);
        }
}

// Lemma 4.2, over random meshes: what is split before a side is longer, or as long and older.
TEST(BisectionFacts, SplitsPropagateToLongerSidesOnly) {
    for (const BisectionRule rule : rules) {
        Bisection mesh(random_mesh(200, 4, 0), {rule});
        std::mt19937 random(5);
        std::size_t most = 0;
        std::vector<double> asked(mesh.vertex_count(), 0);  // by vertex: the length of the side that was asked for
        for (int i = 0; i < 3000; ++i) {
            const auto t = static_cast<Index>(random() % mesh.triangle_count());
            const double wanted = mesh.side_length(t, 0);
            most = std::max(most, mesh.split(t) - 1);
            asked.resize(mesh.vertex_count(), wanted);
        }
        const Progressive whole = mesh.progressive();
        for (Index v = whole.base_vertex_count(); v < whole.vertex_count(); ++v) {
            const auto [a, b] = whole.ends(v);
            EXPECT_GE(length(mesh.place(a) - mesh.place(b)), asked[v] * (1 - 1e-9));
        }
        const BisectionReport r = mesh.report();
        EXPECT_EQ(r.propagation_max, most);
        EXPECT_GT(r.propagation_mean, 0.1);
        EXPECT_EQ(r.requests, 3000u);
        EXPECT_EQ(r.splits, mesh.vertex_count() - mesh.base_vertex_count());
    }
}

TEST(BisectionFacts, ShapesAreFiniteInNumber) {
    std::mt19937 random(6);
    for (const BisectionRule rule : rules)
        for (int i = 0; i < 40;) {
            const glm::dvec2 c = random_apex(random);
            Bisection mesh(one_triangle(c.x, c.y), {rule});
            if (mesh.report().angle_min < 0.45) continue;  // thin triangles have more shapes, and later
            ++i;
            std::size_t classes[2];
            for (const int more : {9, 2}) {
                for (int step = 0; step < more; ++step) mesh.step();
                classes[more == 2] = mesh.report().similarity_classes;
            }
            EXPECT_EQ(classes[1], classes[0]);
            EXPECT_LE(classes[1], 8u);
        }
}

// The conclusion's smoothness: longest sides of neighbours differ by a factor that refinement makes no worse without limit.
TEST(BisectionFacts, NeighboursAreOfLikeSize) {
    for (const BisectionRule rule : rules) {
        Bisection mesh(random_mesh(40, 7, 0), {rule});
        const auto least_ratio = [&] {
            double least = 1;
            for (Index t = 0; t < mesh.triangle_count(); ++t)
                for (int k = 0; k < 3; ++k) {
                    const Index n = mesh.neighbor(t, k);
                    if (n == Bisection::none) continue;
                    const double a = mesh.side_length(t, 0), b = mesh.side_length(n, 0);
                    least = std::min(least, std::min(a, b) / std::max(a, b));
                }
            return least;
        };
        const double angle = mesh.report().angle_min;
        // Towards a point: as uneven as it gets.
        for (int i = 0; i < 600; ++i) {
            const auto at = mesh.nearest_side({300'000.3, 700'000.7});
            ASSERT_TRUE(at);
            mesh.split(at->triangle);
            EXPECT_GE(least_ratio(), std::sin(angle / 2) / 2);
            if (mesh.side_length(at->triangle, 0) < 1) break;
        }
        EXPECT_EQ(mesh.check(), "");
    }
}

// The same mesh with its triangles in another order, and each begun at another corner.
PlainMesh shuffled(PlainMesh mesh, unsigned seed) {
    std::mt19937 random(seed);
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    for (auto& t : mesh.triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    return mesh;
}

TEST(BisectionFacts, TiesDoNotDependOnTheOrderOfTriangles) {
    for (const BisectionRule rule : rules)
        for (const PlainMesh& base : {halved_squares(4, 3), hexagon(), octahedron(), one_triangle(0.5, 0.2)}) {
            Bisection first(base, {rule}), second(shuffled(base, 3), {rule});
            for (int i = 0; i < 3; ++i) {
                first.step();
                second.step();
            }
            EXPECT_EQ(sorted_places(first.mesh()), sorted_places(second.mesh()));
            EXPECT_EQ(first.triangle_count(), second.triangle_count());
        }
}

TEST(BisectionFacts, EquilateralTrianglesBecomeEquilateralOnes) {
    for (const PlainMesh& base : {hexagon(), octahedron()}) {
        Bisection mesh(base);
        RefineGoal goal;
        goal.max_side = 0.1;
        mesh.refine(goal);
        const BisectionReport r = mesh.report();
        EXPECT_EQ(r.pending_triangles, 0u);
        EXPECT_EQ(r.similarity_classes, 1u);
        EXPECT_NEAR(r.angle_min, M_PI / 3, 1e-9);
    }
}

// ---- real terrain ----

PlainMesh real_tin() {
    TinOptions options;
    options.tolerance = 30;
    const Raster raster = read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif");
    const HeightGrid grid(HeightGrid(raster), {900, 200}, {1900, 1100});
    const TinMesh tin = make_tin(grid, options).mesh;
    PlainMesh out;
    for (std::size_t v = 0; v < tin.vertices.size(); ++v)
        out.vertices.emplace_back(tin.vertices[v].x * 73., tin.vertices[v].y * 92., tin.height[v]);
    out.triangles = tin.triangles;
    return out;
}

TEST(BisectionFacts, TheAnglesOfARealTinAreKept) {
    const PlainMesh base = real_tin();
    ASSERT_GT(base.triangles.size(), 5000u);
    for (const SideGeometry sides : {SideGeometry::plan, SideGeometry::space})
        for (const BisectionRule rule : rules) {
            Bisection mesh(base, {rule, sides, {}});
            RefineGoal goal;
            goal.max_triangles = 150'000;
            mesh.refine(goal);
            std::mt19937 random(1);
            for (int i = 0; i < 3000; ++i) mesh.split(static_cast<Index>(random() % mesh.triangle_count()));
            EXPECT_EQ(mesh.check(), "");
            const BisectionReport r = mesh.report();
            EXPECT_GE(r.angle_ratio_min, rule == BisectionRule::modified ? modified_bound : 0.5 - 1e-9);
            EXPECT_GE(r.angle_ratio_min_pending, 0.5 - 1e-9);
            EXPECT_EQ(r.pending_triangles > 0, rule == BisectionRule::modified);
            EXPECT_GE(r.angle_min_complete, r.angle_min);
        }
}

// ---- the quadtree ----

using Corner = std::pair<int, int>;
using Cell = std::set<Corner>;

Raster hilly(int size) {
    Raster r;
    r.width = r.height = size;
    r.name = "hilly";
    std::vector<float> samples;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            samples.push_back(static_cast<float>(100 * std::sin(x * 0.13) * std::cos(y * 0.09 + x * 0.05)));
    r.samples = samples;
    return r;
}

Cell cell_of(const LatticeCorners& c) {
    return {{c.left.x, c.left.y}, {c.right.x, c.right.y}, {c.apex.x, c.apex.y}};
}

template <class OnCell>
void walk(CellCode cell, const LatticeCorners& corners, int levels, OnCell&& on_cell) {
    if (!on_cell(cell, corners) || levels == 0) return;
    walk(2 * cell, PatchLattice::child(corners, 0), levels - 1, on_cell);
    walk(2 * cell + 1, PatchLattice::child(corners, 1), levels - 1, on_cell);
}

TEST(BisectionFacts, AHalvedSquareGivesTheQuadtree) {
    constexpr int size = 65;
    const PatchRaster raster(hilly(size));
    const auto deviation = patch_deviations(raster);
    const PatchLattice& lattice = raster.lattice();
    std::map<Cell, double> deviation_of;
    for (const CellCode root : {raster.grid().root(0), raster.grid().root(1)})
        walk(root, lattice.root_corners(root), lattice.bisection_levels(), [&](CellCode cell, const LatticeCorners& c) {
            const bool finest = bisection_level_of(cell, raster.grid().root_bits()) == lattice.bisection_levels();
            deviation_of[cell_of(c)] = finest ? 0 : static_cast<double>(deviation[cell]);
            return true;
        });
    for (const double tolerance : {60., 10., 2., 0.}) {
        PatchTriangulation quadtree = coarsest(raster);
        refine_to_tolerance(quadtree, deviation, tolerance);
        std::set<Cell> expected;
        for (const CellCode root : {raster.grid().root(0), raster.grid().root(1)})
            walk(root, lattice.root_corners(root), 64, [&](CellCode cell, const LatticeCorners& c) {
                const bool split = quadtree.is_split(cell);
                if (!split) expected.insert(cell_of(c));
                return split;
            });
        for (const SplitOrder order : {SplitOrder::length, SplitOrder::deviation}) {
            Bisection mesh(halved_squares(1, 1, size - 1), {BisectionRule::plain, SideGeometry::plan, {}});
            const auto cell_at = [](const TrianglePlaces& p) {
                Cell cell;
                for (const glm::dvec3& v : p) cell.insert({static_cast<int>(v.x), static_cast<int>(v.y)});
                return cell;
            };
            RefineGoal goal;
            goal.max_deviation = tolerance;
            goal.order = order;
            goal.deviation = [&](std::span<const TrianglePlaces> triangles, std::span<double> out) {
                for (std::size_t i = 0; i < triangles.size(); ++i) out[i] = deviation_of.at(cell_at(triangles[i]));
            };
            EXPECT_EQ(mesh.refine(goal).end, RefineEnd::met);
            std::set<Cell> cells;
            for (Index t = 0; t < mesh.triangle_count(); ++t) cells.insert(cell_at(mesh.places(t)));
            EXPECT_EQ(cells, expected) << tolerance;
        }
    }
}

}  // namespace
}  // namespace planet
