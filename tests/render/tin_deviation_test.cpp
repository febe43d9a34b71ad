// Deviations measured by drawing, against the local measure in double.
#include "render/passes/tin_deviation.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/tin/greedy_tin.h"
#include "render/gl/context.h"
#include "tests/planet/tin_rasters.h"

namespace render {
namespace {

using planet::Delaunay;
using planet::HeightGrid;
using planet::Measured;
using Index = Delaunay::Index;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// In every way into OpenGL that this machine has.
class TinDeviations : public testing::TestWithParam<BackendChoice> {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create({.backend = GetParam()}));
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
    }

  private:
    std::optional<Context> context_;
};

std::vector<Index> all_triangles(const Delaunay& mesh) {
    std::vector<Index> out;
    for (Index t = 0; t < mesh.triangle_slots(); ++t)
        if (mesh.alive(t)) out.push_back(t);
    return out;
}

/// Slivers along the border among them.
void insert_at_random(Delaunay& mesh, const HeightGrid& grid, int count) {
    std::mt19937 random(7);
    for (int i = 0; i < count; ++i)
        mesh.insert({static_cast<int>(random() % static_cast<unsigned>(grid.width())),
                     static_cast<int>(random() % static_cast<unsigned>(grid.height()))});
}

/// What the samples of a triangle deviate, by brute force, metres.
struct Bounds {
    double inside = 0;  ///< of those that no other triangle has: what must be found
    double all = 0;     ///< with those on sides that it shares
};
Bounds bounds(const Delaunay& mesh, const HeightGrid& grid, Index t) {
    Bounds out;
    const auto [a, b, c] = mesh.corners(t);
    const planet::SortedTriangle sorted = planet::sorted_triangle(mesh, grid, t);
    const planet::scan::ScaledDistances<double> distances(grid, sorted);
    for (int y = std::min({a.y, b.y, c.y}); y <= std::max({a.y, b.y, c.y}); ++y)
        for (int x = std::min({a.x, b.x, c.x}); x <= std::max({a.x, b.x, c.x}); ++x) {
            const glm::ivec2 p(x, y);
            const std::int64_t u = planet::orientation(a, b, p), v = planet::orientation(b, c, p),
                               w = planet::orientation(c, a, p);
            if (u < 0 || v < 0 || w < 0 || p == a || p == b || p == c) continue;
            const double d = distances.one(x, y);
            const Index side = u == 0 ? 3 * t : v == 0 ? 3 * t + 1 : w == 0 ? 3 * t + 2 : Delaunay::none;
            if (std::isnan(d)) continue;
            out.all = std::max(out.all, d);
            if (side == Delaunay::none || mesh.twin(side) == Delaunay::none) out.inside = std::max(out.inside, d);
        }
    return out;
}

void expect_measured(const HeightGrid& grid, const Delaunay& mesh) {
    TinDeviation deviation(grid);
    const double off = TinDeviation::steps_off * deviation.depth_step();
    const std::vector<Index> triangles = all_triangles(mesh);
    std::vector<Measured> measured(triangles.size());
    deviation.measure(mesh, triangles, measured);
    double largest = 0, largest_measured = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Bounds b = bounds(mesh, grid, triangles[i]);
        EXPECT_GE(measured[i].deviation, b.inside - off) << "triangle " << i;
        EXPECT_LE(measured[i].deviation, b.all + off) << "triangle " << i;
        EXPECT_EQ(measured[i].deviation, measured[i].priority);
        EXPECT_EQ(measured[i].deviation > 0, measured[i].sample.x >= 0);
        largest = std::max(largest, b.all);
        largest_measured = std::max(largest_measured, measured[i].deviation);
        if (measured[i].sample.x < 0) continue;
        const auto corners = mesh.corners(triangles[i]);
        EXPECT_EQ(std::ranges::find(corners, measured[i].sample), corners.end());
        const planet::scan::ScaledDistances<double> distances(grid, sorted_triangle(mesh, grid, triangles[i]));
        EXPECT_NEAR(distances.one(measured[i].sample.x, measured[i].sample.y), measured[i].deviation, off);
    }
    EXPECT_NEAR(largest, largest_measured, off) << "samples on shared sides are in one of both triangles";
    EXPECT_LT(off, 0.001);
}

TEST_P(TinDeviations, AreThoseOfEverySampleToAFewDepthSteps) {
    for (const bool fractional : {false, true}) {
        const HeightGrid grid = fractional ? planet::fractional_grid(190, 131) : planet::rough_grid(190, 131);
        for (const int points : {0, 1, 5, 60, 900}) {
            Delaunay mesh = coarsest_tin(grid);
            insert_at_random(mesh, grid, points);
            SCOPED_TRACE(points);
            expect_measured(grid, mesh);
        }
    }
}

TEST_P(TinDeviations, AreNoneOverVoids) {
    HeightGrid grid = planet::rough_grid(150, 90);
    for (int y = 20; y < 47; ++y)
        for (int x = y; x < 3 * y; ++x) grid.set({x, y}, nan);
    grid.set({149, 89}, nan);
    Delaunay mesh = coarsest_tin(grid);
    insert_at_random(mesh, grid, 50);
    expect_measured(grid, mesh);
}

TEST_P(TinDeviations, AreNoneInAPlaneHoweverThinItsTriangles) {
    HeightGrid grid(700, 400);
    for (int y = 0; y < 400; ++y)
        for (int x = 0; x < 700; ++x) grid.set({x, y}, static_cast<float>(3 * x - 7 * y));
    grid = HeightGrid(grid, {0, 0}, {699, 399});
    Delaunay mesh = coarsest_tin(grid);
    for (int x = 1; x < 699; x += 3) mesh.insert({x, 399});  // slivers as long as the raster is high
    for (int y = 5; y < 390; y += 50) mesh.insert({350, y});
    TinDeviation deviation(grid);
    const std::vector<Index> triangles = all_triangles(mesh);
    std::vector<Measured> measured(triangles.size());
    deviation.measure(mesh, triangles, measured);
    for (const Measured& m : measured) EXPECT_EQ(m.sample.x, -1) << m.deviation << " m";
}

TEST_P(TinDeviations, OfAFlatRasterAreNone) {
    HeightGrid grid(20, 10);
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 20; ++x) grid.set({x, y}, -12.5f);
    TinDeviation deviation(grid);
    Delaunay mesh = coarsest_tin(grid);
    planet::GreedyOptions options;
    options.measure = &deviation;
    EXPECT_EQ(insert_greedily(mesh, grid, options).triangles, 2u);
}

// Only what an insertion has changed is drawn again, and numbers of triangles come to an end some time.
TEST_P(TinDeviations, AreTheSameFromInsertionToInsertionAsAtOnce) {
    const HeightGrid grid = planet::rough_grid(120, 80);
    TinDeviation step_by_step(grid);
    Delaunay mesh = coarsest_tin(grid);
    std::vector<Measured> kept(mesh.triangle_slots());
    step_by_step.measure(mesh, all_triangles(mesh), kept);
    std::mt19937 random(3);
    for (int i = 0; i < 400; ++i) {
        mesh.insert({static_cast<int>(random() % 120), static_cast<int>(random() % 80)});
        std::vector<Measured> changed(mesh.changed().size());
        step_by_step.measure(mesh, mesh.changed(), changed);
        kept.resize(mesh.triangle_slots());
        for (std::size_t k = 0; k < changed.size(); ++k) kept[mesh.changed()[k]] = changed[k];
    }
    TinDeviation at_once(grid);
    std::vector<Measured> measured(mesh.triangle_slots());
    at_once.measure(mesh, all_triangles(mesh), measured);
    for (std::size_t t = 0; t < measured.size(); ++t) {
        EXPECT_EQ(measured[t].sample, kept[t].sample) << "triangle " << t;
        EXPECT_EQ(measured[t].deviation, kept[t].deviation) << "triangle " << t;
    }
}

// Pixels are hardest to hit far from the middle.
TEST_P(TinDeviations, AreThoseOfEverySampleOfTheLargestRaster) {
    const int most = gl().limits.target_size - 2;
    for (const bool tall : {false, true}) {
        const HeightGrid grid = planet::rough_grid(tall ? 4 : most, tall ? most : 4);
        Delaunay mesh = coarsest_tin(grid);
        insert_at_random(mesh, grid, 400);
        expect_measured(grid, mesh);
    }
}

TEST_P(TinDeviations, OfTooLargeARasterAreRefusedInOneLine) {
    const HeightGrid grid(gl().limits.target_size, 2);
    try {
        const TinDeviation deviation(grid);
        FAIL();
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), planet::Fault::bad_usage);
        EXPECT_NE(std::string(error.what()).find(std::to_string(gl().limits.target_size) + "x2"), std::string::npos);
    }
}

/// Vertices with another one beside them, along a row, a column or a diagonal.
std::size_t crowded(const Delaunay& mesh) {
    std::size_t out = 0;
    for (Index v = 0; v < mesh.vertex_slots(); ++v) {
        bool near = false;
        Index e = mesh.out(v);
        do {
            const glm::ivec2 to = glm::abs(mesh.point(mesh.origin(Delaunay::next(e))) - mesh.point(v));
            near = near || std::max(to.x, to.y) == 1;
            e = mesh.twin(Delaunay::previous(e));
        } while (e != Delaunay::none && e != mesh.out(v));
        out += near;
    }
    return out;
}

TEST(TinByDrawing, OfTheShippedDemIsThatOfTheLocalMeasure) {
    std::optional<Context> context;
    try {
        context.emplace(Context::create());
    } catch (const planet::Error& error) {
        GTEST_SKIP() << error.what();
    }
    const planet::Raster raster = planet::read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif");
    const HeightGrid grid(raster);
    TinDeviation deviation(grid);
    for (const double tolerance : {60.0, 120.0}) {
        planet::GreedyOptions options;
        options.tolerance = tolerance;
        Delaunay local = coarsest_tin(grid), drawn = coarsest_tin(grid);
        const auto by_local = insert_greedily(local, grid, options);
        options.measure = &deviation;
        const auto by_drawing = insert_greedily(drawn, grid, options);
        EXPECT_LE(by_drawing.deviation_max, tolerance) << "certified by the local measure";
        EXPECT_NEAR(static_cast<double>(by_drawing.triangles), static_cast<double>(by_local.triangles),
                    0.05 * static_cast<double>(by_local.triangles));
        EXPECT_LE(static_cast<double>(crowded(drawn)), 1.05 * static_cast<double>(crowded(local)) + 2);
        EXPECT_EQ(drawn.check(), "");
    }
}

TEST_P(TinDeviations, KeepABudgetAndItsBestState) {
    const HeightGrid grid = planet::rough_grid(200, 150);
    TinDeviation deviation(grid);
    for (const std::size_t triangles : {2, 50, 450, 1050}) {
        planet::GreedyOptions options;
        options.max_triangles = triangles;
        Delaunay local = coarsest_tin(grid), drawn = coarsest_tin(grid);
        const auto by_local = insert_greedily(local, grid, options);
        options.measure = &deviation;
        const auto by_drawing = insert_greedily(drawn, grid, options);
        EXPECT_EQ(by_drawing.end, planet::GreedyEnd::budget);
        EXPECT_LE(by_drawing.triangles, triangles);
        EXPECT_GE(by_drawing.triangles + 2, triangles);
        EXPECT_LE(by_drawing.deviation_max, 1.05 * by_local.deviation_max);
    }
}

INSTANTIATE_TEST_SUITE_P(EveryWayIn, TinDeviations,
                         testing::Values(BackendChoice::egl_device, BackendChoice::egl_surfaceless,
                                         BackendChoice::osmesa),
                         [](const auto& parameters) {
                             std::string name(backend_name(parameters.param));
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace render
