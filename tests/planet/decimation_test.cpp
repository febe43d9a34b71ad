// Decimation: costs against brute force, orders against thresholds, and what it is for: a lower RMS deviation.

#include "planet/patches/decimation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <queue>
#include <random>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/patches/candidate_queue.h"
#include "planet/patches/patch_mesh.h"
#include "planet/patches/triangle_rows.h"
#include "planet/quadtree/merging_domain.h"

namespace planet {
namespace {

constexpr auto infinite = std::numeric_limits<double>::infinity();

// No two costs alike.
Raster rough(int width, int height, unsigned seed) {
    Raster r;
    r.width = width;
    r.height = height;
    std::vector<float> heights;
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            heights.push_back(static_cast<float>(300 * std::sin(x * 0.21) * std::cos(y * 0.13 + x * 0.05)) +
                              static_cast<float>(random() % 65536) / 4096);
    r.samples = heights;
    return r;
}

Raster with_hole(Raster r, glm::ivec2 from, glm::ivec2 to) {
    auto& heights = std::get<std::vector<float>>(r.samples);
    for (int y = from.y; y < to.y; ++y)
        for (int x = from.x; x < to.x; ++x)
            heights[static_cast<std::size_t>(y * r.width + x)] = std::numeric_limits<float>::quiet_NaN();
    return r;
}

std::vector<Raster> rasters() {
    return {rough(33, 33, 1),  rough(17, 17, 2), rough(50, 23, 3),
            rough(23, 50, 4),  rough(2, 9, 5),   with_hole(rough(40, 33, 6), {7, 9}, {21, 14}),
            rough(300, 40, 7), rough(3, 2, 8)};
}

PatchTriangulation full(const PatchRaster& raster) {
    PatchTriangulation mesh = coarsest(raster);
    refine_to_level(mesh, mesh.levels());
    return mesh;
}

PatchTriangulation random_mesh(const PatchRaster& raster, unsigned seed, int splits) {
    PatchTriangulation mesh = coarsest(raster);
    std::mt19937 random(seed);
    for (int i = 0; i < splits && mesh.levels() > 0; ++i)
        keep_sample(mesh, raster.lattice(),
                    {static_cast<int>(random() % static_cast<unsigned>(raster.width())),
                     static_cast<int>(random() % static_cast<unsigned>(raster.height()))});
    return mesh;
}

// Squared deviations from the mesh, sample by sample; where void samples spoil a leaf there are none.
double brute_squares(const PatchTriangulation& mesh, const PatchRaster& raster) {
    std::vector<double> deviation(static_cast<std::size_t>(raster.width() * raster.height()));
    mesh.for_each_leaf([&](CellCode leaf) {
        const LatticeCorners c = raster.lattice().corners(leaf);
        const glm::dvec2 u(c.right - c.left), v(c.apex - c.left);
        const double a = static_cast<double>(raster.at(c.left)), b = static_cast<double>(raster.at(c.right)),
                     h = static_cast<double>(raster.at(c.apex)), area = u.x * v.y - u.y * v.x;
        if (std::isnan(a + b + h)) return;
        const TriangleRows rows(c);
        for (int y = rows.bottom(); y <= std::min(rows.top(), raster.height() - 1); ++y)
            for (int x = rows.at(y).first; x <= std::min(rows.at(y).last, raster.width() - 1); ++x) {
                const glm::dvec2 d = glm::dvec2(x, y) - glm::dvec2(c.left);
                const double right = (d.x * v.y - d.y * v.x) / area, apex = (u.x * d.y - u.y * d.x) / area;
                const double sample = static_cast<double>(raster.at({x, y}));
                if (!std::isnan(sample))
                    deviation[static_cast<std::size_t>(y * raster.width() + x)] =
                        a + right * (b - a) + apex * (h - a) - sample;
            }
    });
    double sum = 0;
    for (const double d : deviation) sum += d * d;
    return sum;
}

std::size_t count_triangles(const PatchTriangulation& mesh, const PatchRaster& raster) {
    std::size_t n = 0;
    mesh.for_each_leaf([&](CellCode leaf) { n += triangles_of_leaf(raster, raster.lattice().corners(leaf)); });
    return n;
}

template <class OnDiamond>
void for_each_split_diamond(const PatchTriangulation& mesh, OnDiamond&& on_diamond) {
    for (int rank = 0; rank < mesh.topology().root_count(); ++rank)
        mesh.for_each_split_below(mesh.topology().root(rank), [&](CellCode c) {
            if (diamond(mesh.topology(), c) == c) on_diamond(c);
        });
}

bool same(const PatchTriangulation& a, const PatchTriangulation& b) {
    std::vector<CellCode> cells[2];
    for (int rank = 0; rank < a.topology().root_count(); ++rank) {
        a.for_each_split_below(a.topology().root(rank), [&](CellCode c) { cells[0].push_back(c); });
        b.for_each_split_below(b.topology().root(rank), [&](CellCode c) { cells[1].push_back(c); });
    }
    return cells[0] == cells[1];
}

// "Split iff the saturated deviation exceeds the tolerance", from the roots.
PatchTriangulation threshold_walk(const PatchRaster& raster, const DenseQuadtree<float>& saturated, double tolerance) {
    PatchTriangulation mesh = coarsest(raster);
    const std::function<void(CellCode)> below = [&](CellCode c) {
        if (mesh.level_of(c) == mesh.levels() || !(static_cast<double>(saturated[c]) > tolerance)) return;
        mesh.split_cells().insert(c);
        below(c << 1);
        below(c << 1 | 1);
    };
    for (int rank = 0; rank < mesh.topology().root_count(); ++rank) below(mesh.topology().root(rank));
    return mesh;
}

TEST(SquaredDeviation, OfAnyConformingMeshCountsEverySampleOnce) {
    for (const Raster& source : rasters()) {
        const PatchRaster raster(source);
        const auto squared = patch_squared_deviations(raster);
        const bool has_void = raster.has_void();
        for (unsigned seed = 0; seed < 20; ++seed) {
            PatchTriangulation mesh = random_mesh(raster, seed, static_cast<int>(seed * seed) / 4);
            if (has_void) refine_to_tolerance(mesh, patch_deviations(raster), 1e9);
            const double brute = brute_squares(mesh, raster);
            EXPECT_NEAR(squared_deviation(mesh, squared), brute, 1e-9 * brute + 1e-9) << raster.width() << " " << seed;
        }
    }
}

TEST(SquaredDeviation, TheSameBitsOnAnyNumberOfThreads) {
    const PatchRaster raster(rough(300, 150, 9));
    const auto one = patch_squared_deviations(raster, 1), five = patch_squared_deviations(raster, 5);
    for (int level = 0; level < one.levels(); ++level)
        EXPECT_TRUE(std::ranges::equal(one.level(level), five.level(level)));
}

// Every vertex of full and of adaptive meshes; domains that close around themselves take 3 x 3 patches.
TEST(MergingDomain, IsWhatRemovalWouldMerge) {
    std::vector<PatchTriangulation> meshes;
    for (const Raster& source : {rough(33, 33, 1), rough(49, 18, 2)}) {
        const PatchRaster raster(source);
        meshes.push_back(full(raster));
        for (unsigned seed = 0; seed < 5; ++seed) meshes.push_back(random_mesh(raster, seed, 100));
    }
    meshes.emplace_back(PatchGrid(3, 3), 8);
    refine_to_level(meshes.back(), 8);
    std::size_t largest = 0;
    for (const PatchTriangulation& mesh : meshes) {
        MergingDomain<PatchGrid, DenseSplitSet> domain(mesh);
        for_each_split_diamond(mesh, [&](CellCode vertex) {
            std::vector<CellCode> visited, removed;
            domain.visit(vertex, [&](CellCode c, int level) {
                EXPECT_EQ(level, mesh.level_of(c));
                visited.push_back(c);
            });
            PatchTriangulation without = mesh;
            without.remove(vertex, [&](CellCode c, int) { removed.push_back(c); });
            EXPECT_EQ(visited, removed);
            largest = std::max(largest, removed.size());
        });
    }
    EXPECT_EQ(largest, 238u);
}

// What a vertex costs at most: everything in its merging domain in the full triangulation.
TEST(Decimation, SaturatedIsTheLargestDeviationOfTheFullMergingDomain) {
    for (const Raster& source : rasters()) {
        if (source.width > 50) continue;
        const PatchRaster raster(source);
        const auto deviation = patch_deviations(raster);
        const auto of_domain = saturated(raster.grid(), deviation);
        const PatchTriangulation all = full(raster);
        for_each_split_diamond(all, [&](CellCode vertex) {
            PatchTriangulation mesh = all;
            float largest = 0;
            mesh.remove(vertex, [&](CellCode merged, int) {
                mesh.for_each_split_below(merged, [&](CellCode c) { largest = std::max(largest, deviation[c]); });
            });
            EXPECT_EQ(of_domain[vertex], largest);
        });
    }
}

TEST(Decimation, ToALargestDeviationIsTheThresholdWalk) {
    for (const Raster& source : rasters()) {
        const PatchRaster raster(source);
        const auto deviation = patch_deviations(raster);
        const auto of_domain = saturated(raster.grid(), deviation);
        for (const double tolerance : {0.0, 0.5, 3.0, 12.0, 40.0, 1e9}) {
            PatchTriangulation mesh = full(raster);
            const auto report =
                decimate(mesh, raster, deviation, {.priority = DecimationPriority::max, .max_cost = tolerance});
            const PatchTriangulation walk = threshold_walk(raster, of_domain, tolerance);
            EXPECT_TRUE(same(mesh, walk)) << raster.width() << " " << tolerance;
            EXPECT_EQ(report.triangles, count_triangles(mesh, raster));
            EXPECT_LE(report.highest_cost, tolerance);

            // To as many triangles: the same, but for ties in which it may stop earlier.
            PatchTriangulation by_budget = full(raster);
            const auto to_budget = decimate(by_budget, raster, deviation,
                                            {.priority = DecimationPriority::max, .max_triangles = report.triangles});
            EXPECT_LE(to_budget.triangles, report.triangles);
            EXPECT_LE(to_budget.highest_cost, report.highest_cost);
            EXPECT_FALSE(by_budget.check());
        }
    }
}

// Begun anew before every removal, each must be the cheapest of all, of all vertices and whole domains.
TEST(Decimation, TheCheapestMergingDomainGoesFirstAtItsTrueCost) {
    for (const Raster& source : {rough(9, 9, 1), rough(11, 5, 2), with_hole(rough(9, 9, 3), {1, 2}, {4, 4})}) {
        const PatchRaster raster(source);
        const auto deviation = patch_deviations(raster);
        PatchTriangulation mesh = full(raster);
        std::size_t triangles = count_triangles(mesh, raster);
        for (int removals = 0;; ++removals) {
            double cheapest = infinite;
            const double squares = brute_squares(mesh, raster);
            for_each_split_diamond(mesh, [&](CellCode vertex) {
                PatchTriangulation without = mesh;
                bool may_go = true;
                without.remove(vertex, [&](CellCode merged, int) { may_go &= std::isfinite(deviation[merged]); });
                const auto fewer = triangles - count_triangles(without, raster);
                if (may_go && fewer > 0)
                    cheapest =
                        std::min(cheapest, (brute_squares(without, raster) - squares) / static_cast<double>(fewer));
            });
            const auto report = decimate(mesh, raster, deviation, {.max_triangles = triangles - 1});
            EXPECT_FALSE(mesh.check());
            EXPECT_EQ(report.triangles, count_triangles(mesh, raster));
            if (cheapest == infinite) {
                EXPECT_EQ(report.triangles, triangles);
                EXPECT_GT(removals, 5);
                break;
            }
            if (raster.width() == 9) {
                EXPECT_EQ(report.removals, 1u);  // else some are free
            }
            EXPECT_NEAR(report.highest_cost, cheapest, 1e-6 * std::abs(cheapest) + 1e-9);
            triangles = report.triangles;
        }
    }
}

// Costs kept up to date in one run against those worked out anew for each removal.
TEST(Decimation, InOneRunIsAsGoodAsAnewForEveryRemoval) {
    for (const Raster& source : {rough(33, 33, 1), rough(50, 23, 3), with_hole(rough(40, 33, 6), {7, 9}, {21, 14})}) {
        const PatchRaster raster(source);
        const auto deviation = patch_deviations(raster);
        PatchTriangulation stepwise = full(raster);
        std::size_t triangles = count_triangles(stepwise, raster);
        for (int i = 0; i < 400; ++i) {
            const auto step = decimate(stepwise, raster, deviation, {.max_triangles = triangles - 1});
            triangles = step.triangles;
        }
        PatchTriangulation mesh = full(raster);
        const auto report = decimate(mesh, raster, deviation, {.max_triangles = triangles});
        EXPECT_NEAR(brute_squares(mesh, raster) / brute_squares(stepwise, raster), 1, 0.01) << raster.width();
        EXPECT_NEAR(report.rms_m, std::sqrt(brute_squares(mesh, raster) / static_cast<double>(raster.valid_samples())),
                    1e-9);
        EXPECT_FALSE(mesh.check());
    }
}

TEST(Decimation, ReportsTheTrianglesAndTheRmsOfTheMeshItLeaves) {
    for (const Raster& source : rasters()) {
        const PatchRaster raster(source);
        const auto deviation = patch_deviations(raster);
        for (const double max_cost : {0.0, 1.0, 100.0, infinite}) {
            PatchTriangulation mesh = full(raster);
            const auto report = decimate(mesh, raster, deviation, {.max_cost = max_cost});
            EXPECT_FALSE(mesh.check());
            EXPECT_EQ(report.triangles, extract(mesh, raster).triangles.size());
            EXPECT_EQ(report.triangles_before, count_triangles(full(raster), raster));
            EXPECT_LE(report.highest_cost, max_cost);
            EXPECT_NEAR(report.rms_m,
                        std::sqrt(brute_squares(mesh, raster) / static_cast<double>(raster.valid_samples())), 1e-6);
        }
    }
}

TEST(Decimation, CellsThatMixWithVoidStaySplit) {
    const PatchRaster raster(with_hole(rough(90, 33, 6), {7, 9}, {21, 14}));
    const auto deviation = patch_deviations(raster);
    for (const DecimationPriority priority : {DecimationPriority::max, DecimationPriority::rms}) {
        PatchTriangulation mesh = full(raster);
        decimate(mesh, raster, deviation, {.priority = priority});
        // Exactly what the hole needs is left.
        PatchTriangulation least = coarsest(raster);
        refine_to_tolerance(least, deviation, 1e9);
        EXPECT_TRUE(same(mesh, least));
    }
}

TEST(Decimation, KeptSamplesStayWithAllTheyDependOn) {
    const PatchRaster raster(rough(60, 23, 3));
    const auto deviation = patch_deviations(raster);
    const std::vector<glm::ivec2> keep{{0, 0}, {13, 7}, {59, 22}, {31, 1}, {1, 22}};
    for (const DecimationPriority priority : {DecimationPriority::max, DecimationPriority::rms}) {
        PatchTriangulation mesh = full(raster);
        decimate(mesh, raster, deviation, {.priority = priority, .keep = keep});
        PatchTriangulation least = coarsest(raster);
        for (const glm::ivec2 sample : keep) keep_sample(least, raster.lattice(), sample);
        for_each_split_diamond(least, [&](CellCode c) { EXPECT_TRUE(mesh.is_split(c)); });
        EXPECT_EQ(count_triangles(mesh, raster), count_triangles(least, raster));
        EXPECT_FALSE(mesh.check());
        if (priority == DecimationPriority::max) {
            EXPECT_TRUE(same(mesh, least));  // rms leaves vertices whose removal would save nothing
        }
    }
    // A sample that the mesh given does not have keeps nothing.
    PatchTriangulation mesh = coarsest(raster);
    keep_sample(mesh, raster.lattice(), {16, 16});
    decimate(mesh, raster, deviation, {.keep = keep});
    EXPECT_TRUE(same(mesh, coarsest(raster)));
}

TEST(Decimation, EndsAtOnceWhereThereIsNothingToDo) {
    const PatchRaster raster(rough(33, 33, 3));
    const auto deviation = patch_deviations(raster);
    for (const DecimationPriority priority : {DecimationPriority::max, DecimationPriority::rms}) {
        PatchTriangulation mesh = full(raster);
        const std::size_t all = count_triangles(mesh, raster);
        EXPECT_EQ(decimate(mesh, raster, deviation, {.priority = priority, .max_triangles = all}).removals, 0u);
        EXPECT_TRUE(same(mesh, full(raster)));
        EXPECT_EQ(decimate(mesh, raster, deviation, {.priority = priority, .max_cost = 1e-12}).removals, 0u);
        EXPECT_TRUE(same(mesh, full(raster)));
    }
    PatchTriangulation mesh = full(raster);
    EXPECT_THROW(decimate(mesh, raster, deviation, {.max_cost = std::nan("")}), Error);
}

TEST(Decimation, TellsHowFarItIs) {
    const PatchRaster raster(rough(257, 257, 9), 1 << 20);
    std::vector<double> deviations_told, told;
    const DenseQuadtree<float> deviation =
        patch_deviations(raster, 1, [&](double part) { deviations_told.push_back(part); });
    ASSERT_FALSE(deviations_told.empty());
    EXPECT_TRUE(std::ranges::is_sorted(deviations_told));
    EXPECT_EQ(deviations_told.back(), 1);
    for (const DecimationPriority priority : {DecimationPriority::max, DecimationPriority::rms}) {
        told.clear();
        PatchTriangulation mesh = full(raster);
        decimate(mesh, raster, deviation,
                 {.priority = priority, .max_triangles = 100, .progress = [&](double part) { told.push_back(part); }});
        EXPECT_GE(told.size(), 2u);
        EXPECT_TRUE(std::ranges::is_sorted(told));
        EXPECT_GT(told.front(), 0.2);
        EXPECT_LE(told.back(), 1);
    }
}

TEST(Decimation, AFlatRasterCostsNothing) {
    Raster flat = rough(40, 70, 1);
    for (float& h : std::get<std::vector<float>>(flat.samples)) h = 1234.5f;
    const PatchRaster raster(flat);
    for (const DecimationPriority priority : {DecimationPriority::max, DecimationPriority::rms}) {
        PatchTriangulation mesh = full(raster);
        decimate(mesh, raster, patch_deviations(raster), {.priority = priority, .max_cost = 0});
        EXPECT_TRUE(same(mesh, coarsest(raster)));
    }
}

TEST(Decimation, CandidatesComeInOrderWhateverTheHeap) {
    std::mt19937 random(1);
    std::vector<Candidate> all;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> expected;
    const auto next = [&] { return Candidate{static_cast<float>(random() % 50), random() % 40}; };
    for (int i = 0; i < 1000; ++i) expected.push(all.emplace_back(next()));
    CandidateQueue queue(all, 4);
    for (int i = 0; i < 20000; ++i) {
        if (random() % 100 < (i < 10000 ? 55u : 30u)) {
            const Candidate c = next();
            expected.push(c);
            queue.push(c);
        } else if (!expected.empty()) {
            ASSERT_FALSE(queue.empty());
            EXPECT_EQ(queue.top().cost, expected.top().cost);
            EXPECT_EQ(queue.top().cell, expected.top().cell);
            queue.pop();
            expected.pop();
        }
        ASSERT_EQ(queue.empty(), expected.empty());
    }
    EXPECT_TRUE(CandidateQueue().empty());
}

TEST(Decimation, OfTheDemBeatsTheLeastMeshByAQuarterInRms) {
    const PatchRaster raster(read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif"));
    const auto deviation = patch_deviations(raster);
    PatchTriangulation least = coarsest(raster);
    refine_to_tolerance(least, deviation, 20);
    const std::size_t triangles = count_triangles(least, raster);

    PatchTriangulation mesh = full(raster);
    const auto report = decimate(mesh, raster, deviation, {.max_triangles = triangles});
    EXPECT_FALSE(mesh.check());
    EXPECT_EQ(report.triangles, count_triangles(mesh, raster));
    EXPECT_LE(report.triangles, triangles);
    EXPECT_GT(report.triangles, triangles - 1000);
    EXPECT_LT(std::sqrt(brute_squares(mesh, raster)), 0.75 * std::sqrt(brute_squares(least, raster)));
    EXPECT_NEAR(report.rms_m, std::sqrt(brute_squares(mesh, raster) / static_cast<double>(raster.valid_samples())),
                1e-6);

    PatchTriangulation by_largest = full(raster);
    decimate(by_largest, raster, deviation, {.priority = DecimationPriority::max, .max_cost = 20});
    EXPECT_TRUE(same(by_largest, threshold_walk(raster, saturated(raster.grid(), deviation), 20)));
}

}  // namespace
}  // namespace planet
