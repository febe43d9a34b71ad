// Greedy insertion in strict order: what goes in first, budgets, measures, stages, the error grid.

#include "planet/tin/greedy_tin.h"

#include <gtest/gtest.h>

#include "planet/error.h"
#include "planet/tin/error_grid.h"
#include "planet/tin/void_border.h"
#include "tin_rasters.h"

namespace planet {
namespace {

using Index = Delaunay::Index;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Made {
    Delaunay mesh;
    GreedyReport report;
    TinMesh tin;
};

Made make(const HeightGrid& grid, GreedyOptions options) {
    Made out{coarsest_tin(grid), {}, {}};
    out.report = insert_greedily(out.mesh, grid, options);
    out.tin = triangles_over_samples(out.mesh, grid);
    return out;
}

GreedyOptions budget(std::size_t triangles) {
    GreedyOptions options;
    options.max_triangles = triangles;
    return options;
}

GreedyOptions tolerance(double metres) {
    GreedyOptions options;
    options.tolerance = metres;
    return options;
}

TEST(TinGreedy, FirstGoesTheSampleFarthestFromTwoTriangles) {
    const HeightGrid grid = rough_grid(80, 60);
    const std::vector<float> before = deviation_grid(coarsest_tin(grid), grid);
    const auto worst = static_cast<int>(std::max_element(before.begin(), before.end()) - before.begin());
    const Made made = make(grid, budget(4));
    ASSERT_GE(made.mesh.vertex_slots(), 5u);
    EXPECT_EQ(made.mesh.point(4), glm::ivec2(worst % 80, worst / 80));
}

TEST(TinGreedy, KeepsTheToleranceExactly) {
    for (const double metres : {0.0, 2.0, 10.0, 500.0})
        for (const bool fractional : {false, true}) {
            const HeightGrid grid = fractional ? fractional_grid(90, 70) : rough_grid(90, 70);
            const Made made = make(grid, tolerance(metres));
            EXPECT_EQ(made.report.end, GreedyEnd::tolerance);
            EXPECT_EQ(made.mesh.check(), "");
            EXPECT_TRUE(sound(made.tin));
            EXPECT_EQ(made.tin.triangles.size(), made.report.triangles);
            const BruteDeviation d = brute_deviation(made.tin, grid);
            EXPECT_NEAR(d.max, made.report.deviation_max, 1e-9);
            EXPECT_LE(made.report.deviation_max, metres);
            EXPECT_EQ(d.uncovered, 0u);
        }
}

TEST(TinGreedy, ABudgetGivesNeverMoreAndAtMostTwoFewer) {
    const HeightGrid grid = rough_grid(200, 150);
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t triangles : {2, 3, 4, 50, 150, 250, 450, 750, 1050, 5000}) {
        const Made made = make(grid, budget(triangles));
        EXPECT_EQ(made.report.end, GreedyEnd::budget);
        EXPECT_LE(made.tin.triangles.size(), triangles);
        EXPECT_GE(made.tin.triangles.size() + 2, triangles);
        EXPECT_EQ(made.tin.triangles.size(), made.report.triangles);
        EXPECT_NEAR(brute_deviation(made.tin, grid).max, made.report.deviation_max, 1e-9);
        EXPECT_LE(made.report.deviation_max, before) << "a larger budget passes through the states of a smaller one";
        before = made.report.deviation_max;
        EXPECT_EQ(made.mesh.check(), "");
    }
}

TEST(TinGreedy, ABudgetEndsInTheBestStateOnTheWay) {
    const HeightGrid grid = rough_grid(120, 90, 4);
    // Every state of plain greedy insertion.
    Delaunay mesh = coarsest_tin(grid);
    std::size_t returned = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t triangles = 2; triangles < 300;) {
        const std::vector<float> deviation = deviation_grid(mesh, grid);
        const auto worst = std::max_element(deviation.begin(), deviation.end());
        best = std::min(best, static_cast<double>(*worst));
        const Made made = make(grid, budget(triangles));
        EXPECT_LE(made.report.deviation_max, best + 1e-4) << triangles;
        returned += made.report.taken_back;
        const auto at = static_cast<int>(worst - deviation.begin());
        mesh.insert({at % 120, at / 120});
        triangles = mesh.triangle_count();
    }
    EXPECT_GT(returned, 0u) << "some states on the way are worse than those before";
}

TEST(TinGreedy, WhicheverComesFirst) {
    const HeightGrid grid = rough_grid(100, 100);
    GreedyOptions both = tolerance(50);
    both.max_triangles = 100000;
    const Made wide = make(grid, both);
    EXPECT_EQ(wide.report.end, GreedyEnd::tolerance);
    both.max_triangles = wide.report.triangles / 2;
    const Made tight = make(grid, both);
    EXPECT_EQ(tight.report.end, GreedyEnd::budget);
    EXPECT_GT(tight.report.deviation_max, 50);
    both.max_triangles = wide.report.triangles;
    EXPECT_EQ(make(grid, both).report.end, GreedyEnd::tolerance);
}

TEST(TinGreedy, MoreBudgetThanSamples) {
    const HeightGrid grid = rough_grid(5, 4);
    const Made made = make(grid, budget(1000));
    EXPECT_EQ(made.report.end, GreedyEnd::tolerance);
    EXPECT_EQ(made.report.deviation_max, 0);
    EXPECT_LE(made.tin.triangles.size(), 24u);
}

// A single sample that is far off draws the local measure, region by region, away from where there is more to gain.
TEST(TinGreedy, MeasuresByTheSumLowerTheSum) {
    HeightGrid grid = rough_grid(200, 200);
    for (int y = 0; y < 200; ++y)
        for (int x = 100; x < 200; ++x) grid.set({x, y}, x % 20 == 7 && y % 20 == 11 ? 600.0f : 0.0f);
    const auto sums = [&](const Made& made) {
        double sum = 0, squares = 0;
        for (const float d : deviation_grid(made.mesh, grid)) {
            sum += static_cast<double>(d);
            squares += static_cast<double>(d) * static_cast<double>(d);
        }
        return std::pair{sum, squares};
    };
    const Made local = make(grid, budget(150));
    for (const TinMetric metric : {TinMetric::regional, TinMetric::rms}) {
        const auto measure = make_measure(metric, grid);
        GreedyOptions options = budget(150);
        options.measure = measure.get();
        const Made made = make(grid, options);
        EXPECT_LE(made.tin.triangles.size(), 150u);
        EXPECT_GE(made.tin.triangles.size(), 148u);
        EXPECT_LT(sums(made).first, sums(local).first);
        EXPECT_LT(sums(made).second, sums(local).second);
        EXPECT_GT(made.report.deviation_max, local.report.deviation_max);
        options.max_triangles = 1000000;
        options.tolerance = 30;
        const Made bounded = make(grid, options);
        EXPECT_EQ(bounded.report.end, GreedyEnd::tolerance);
        EXPECT_LE(brute_deviation(bounded.tin, grid).max, 30);
    }
}

// A measure that sees eight metres as nothing: as one with a coarse depth would.
class CoarseMeasure : public TinMeasure {
  public:
    explicit CoarseMeasure(const HeightGrid& grid) : local_(make_measure(TinMetric::local, grid)) {}
    void measure(const Delaunay& mesh, std::span<const Index> triangles, std::span<Measured> out) override {
        local_->measure(mesh, triangles, out);
        for (Measured& m : out) {
            m.priority = m.deviation = 8 * std::floor(m.deviation / 8);
            if (m.deviation == 0) m.sample = glm::ivec2(-1);
        }
        calls += triangles.size();
    }
    bool exact() const override { return false; }
    std::size_t calls = 0;

  private:
    std::unique_ptr<TinMeasure> local_;
};

TEST(TinGreedy, AMeasureThatIsNotExactIsMadeGood) {
    const HeightGrid grid = rough_grid(90, 90);
    CoarseMeasure coarse(grid);
    GreedyOptions options = tolerance(5);
    options.measure = &coarse;
    const Made made = make(grid, options);
    EXPECT_GT(coarse.calls, 1000u);
    EXPECT_LE(brute_deviation(made.tin, grid).max, 5);
}

TEST(TinGreedy, StagesShowTheDeviationBeforeTheInsertion) {
    const HeightGrid grid = rough_grid(150, 100);
    GreedyOptions options = budget(500);
    options.stages = {50, 150, 300};
    std::vector<TinStage> stages;
    options.at_stage = [&](TinStage&& stage) { stages.push_back(std::move(stage)); };
    make(grid, options);
    ASSERT_EQ(stages.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(stages[i].asked, options.stages[i]);
        EXPECT_LE(stages[i].mesh.triangles.size(), stages[i].asked);
        EXPECT_GE(stages[i].mesh.triangles.size() + 2, stages[i].asked);
        const auto brightest = std::max_element(stages[i].deviation.begin(), stages[i].deviation.end());
        const auto at = static_cast<int>(brightest - stages[i].deviation.begin());
        EXPECT_EQ(stages[i].inserted, glm::ivec2(at % 150, at / 150));
        EXPECT_NEAR(static_cast<double>(*brightest), stages[i].deviation_max, 1e-3);
        EXPECT_NE(std::find(stages[i].mesh.vertices.begin(), stages[i].mesh.vertices.end(), stages[i].inserted),
                  stages[i].mesh.vertices.end());
    }
}

TEST(TinGreedy, VoidsStayEmptyAndCountForNothing) {
    HeightGrid grid = rough_grid(60, 60);
    for (int y = 20; y < 33; ++y)
        for (int x = 15; x < 40 + y % 3; ++x) grid.set({x, y}, nan);
    const Made free = make(grid, tolerance(10));
    EXPECT_EQ(brute_deviation(free.tin, grid).voids, 0u);
    EXPECT_LE(brute_deviation(free.tin, grid).max, 10);
    EXPECT_EQ(brute_deviation(free.tin, grid).uncovered, 0u);
    const std::size_t least = triangles_over_samples(coarsest_tin(grid), grid).triangles.size();
    const Made made = make(grid, budget(least + 101));
    EXPECT_LE(made.tin.triangles.size(), least + 101);
    EXPECT_GE(made.tin.triangles.size(), least + 99);
    EXPECT_EQ(made.tin.triangles.size(), made.report.triangles);
    EXPECT_THROW(make(grid, budget(least - 1)), Error);
}

TEST(TinGreedy, RefusesWhatIsOutOfRange) {
    const HeightGrid grid = rough_grid(10, 10);
    EXPECT_THROW(make(grid, tolerance(-1)), Error);
    EXPECT_THROW(make(grid, tolerance(std::nan(""))), Error);
    EXPECT_THROW(make(grid, budget(1)), Error);
    EXPECT_THROW(make(grid, budget(0)), Error);
}

// ---- the error grid ----

TEST(TinErrorGrid, AllWaysToLocateGiveTheSameTin) {
    const HeightGrid grid = rough_grid(130, 100);
    std::vector<Delaunay> meshes;
    std::vector<std::size_t> measured;
    for (const LocateWay way : {LocateWay::naive, LocateWay::cells, LocateWay::spans}) {
        meshes.push_back(coarsest_tin(grid));
        measured.push_back(insert_by_error_grid(meshes.back(), grid, 0, 500, way));
        EXPECT_EQ(meshes.back().check(), "");
    }
    const Made greedy = make(grid, budget(500));
    ASSERT_EQ(greedy.report.taken_back, 0u);
    meshes.push_back(greedy.mesh);
    for (const Delaunay& mesh : meshes) {
        ASSERT_EQ(mesh.vertex_slots(), meshes[0].vertex_slots());
        for (Index v = 0; v < mesh.vertex_slots(); ++v) ASSERT_EQ(mesh.point(v), meshes[0].point(v)) << v;
    }
    EXPECT_EQ(measured[0], measured[1]);
    EXPECT_LT(measured[2], measured[1]) << "triangles are less than the rectangle around them";
    EXPECT_LT(measured[1], 300 * grid.count() / 4) << "only what is dirty is measured again";
}

TEST(TinErrorGrid, ShowsTheDeviationOfEverySample) {
    const HeightGrid grid = rough_grid(64, 50);
    for (const LocateWay way : {LocateWay::naive, LocateWay::cells, LocateWay::spans}) {
        ErrorGrid errors(grid, way);
        Delaunay mesh = coarsest_tin(grid);
        errors.update(mesh, std::array<Index, 2>{0, 1});
        for (int i = 0; i < 60; ++i) {
            mesh.insert(errors.largest().sample);
            errors.update(mesh, mesh.changed());
        }
        const std::vector<float> expected = deviation_grid(mesh, grid);
        for (std::size_t i = 0; i < expected.size(); ++i)
            ASSERT_EQ(static_cast<float>(errors.deviations()[i]), expected[i]) << i;
    }
}

TEST(TinErrorGrid, CellsFindWhatNaiveSearchFinds) {
    std::mt19937 random(2);
    Delaunay mesh({0, 0}, {200, 90});
    const auto naive = make_naive_finder(), cells = make_cell_finder({0, 0}, {200, 90});
    cells->update(mesh, std::array<Index, 2>{0, 1});
    for (int i = 0; i < 200; ++i) {
        mesh.insert({random() % 201, random() % 91});
        cells->update(mesh, mesh.changed());
        for (int k = 0; k < 20; ++k) {
            const glm::ivec2 p(random() % 201, random() % 91);
            ASSERT_EQ(cells->find(mesh, p), naive->find(mesh, p));
        }
    }
}

TEST(TinErrorGrid, AsAMeasureMakesTheSameTinUnderABudget) {
    HeightGrid grid = rough_grid(70, 60);
    for (int y = 20; y < 26; ++y)
        for (int x = 30; x < 41; ++x) grid.set({x, y}, nan);
    for (const std::size_t triangles : {200u, 301u, 500u}) {
        const Made plain = make(grid, budget(triangles));
        for (const LocateWay way : {LocateWay::naive, LocateWay::cells, LocateWay::spans}) {
            const auto measure = make_error_grid_measure(grid, way);
            GreedyOptions options = budget(triangles);
            options.measure = measure.get();
            const Made made = make(grid, options);
            EXPECT_EQ(made.tin.triangles, plain.tin.triangles);
            EXPECT_EQ(made.report.taken_back, plain.report.taken_back);
            EXPECT_EQ(made.report.deviation_max, plain.report.deviation_max);
        }
    }
}

}  // namespace
}  // namespace planet
