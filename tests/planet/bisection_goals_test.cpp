// What a refinement is for: lengths, deviations, budgets, regions, points, placed vertices; and meshes that are none.

#include <gtest/gtest.h>

#include "bisection_meshes.h"
#include "planet/bisection/progressive.h"
#include "planet/error.h"

namespace planet {
namespace {

using Index = Bisection::Index;

double longest_side(const PlainMesh& mesh) {
    double longest = 0;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(longest, length(mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]));
    return longest;
}

double surface(double x, double y) {
    return 20'000 * std::sin(x * 2e-5) * std::cos(y * 1.5e-5);
}

// The largest deviation at the middle and the middles of the sides, which is what the tests refine for.
double deviation_of(const TrianglePlaces& p) {
    double most = 0;
    for (const glm::dvec3& w :
         {glm::dvec3(1. / 3), glm::dvec3(0.5, 0.5, 0), glm::dvec3(0, 0.5, 0.5), glm::dvec3(0.5, 0, 0.5)}) {
        const glm::dvec3 at = w.x * p[0] + w.y * p[1] + w.z * p[2];
        most = std::max(most, std::abs(at.z - surface(at.x, at.y)));
    }
    return most;
}

void measure(std::span<const TrianglePlaces> triangles, std::span<double> out) {
    for (std::size_t i = 0; i < triangles.size(); ++i) out[i] = deviation_of(triangles[i]);
}

Bisection on_surface(unsigned seed = 1) {
    PlainMesh base = random_mesh(30, seed, 0);
    for (glm::dvec3& p : base.vertices) p.z = surface(p.x, p.y);
    BisectionOptions options;
    options.sides = SideGeometry::plan;
    options.place = [](const glm::dvec3& a, const glm::dvec3& b) {
        const glm::dvec3 p = (a + b) * 0.5;
        return glm::dvec3(p.x, p.y, surface(p.x, p.y));
    };
    return Bisection(base, options);
}

TEST(BisectionGoals, NoSideIsLongerThanAsked) {
    for (const double most : {3e5, 5e4, 1.3e4}) {
        const PlainMesh base = random_mesh(40, 3, 100);
        Bisection mesh(base);
        RefineGoal goal;
        goal.max_side = most;
        EXPECT_EQ(mesh.refine(goal).end, RefineEnd::met);
        EXPECT_LE(longest_side(mesh.mesh()), most * (1 + 1e-12));
        EXPECT_LE(mesh.report().side_max, most);
        EXPECT_EQ(conforming(mesh.mesh(), base), "");
        // Every split was needed: the parent side of each vertex was too long.
        const Progressive whole = mesh.progressive();
        for (Index v = whole.base_vertex_count(); v < whole.vertex_count(); ++v) {
            const auto [a, b] = whole.ends(v);
            EXPECT_GT(length(whole.place(a) - whole.place(b)), most * (1 - 1e-12));
        }
    }
}

TEST(BisectionGoals, SidesAreJudgedInPlanOrInSpace) {
    PlainMesh steep = halved_squares(1, 1, 1);
    for (std::size_t v = 0; v < 4; ++v) steep.vertices[v].z = 1000 * steep.vertices[v].x;
    RefineGoal goal;
    goal.max_side = 0.8;
    Bisection plan(steep, {BisectionRule::modified, SideGeometry::plan, {}}), space(steep);
    plan.refine(goal);
    space.refine(goal);
    EXPECT_LT(plan.triangle_count(), 20u);
    EXPECT_GT(space.triangle_count(), 1000u);
    EXPECT_LE(space.report().side_max, 0.8);
}

TEST(BisectionGoals, DeviationsAreMetAndTheLargestGoesFirst) {
    for (const SplitOrder order : {SplitOrder::length, SplitOrder::deviation}) {
        Bisection mesh = on_surface();
        RefineGoal goal;
        goal.max_deviation = 300;
        goal.deviation = measure;
        goal.order = order;
        const RefineResult result = mesh.refine(goal);
        EXPECT_EQ(result.end, RefineEnd::met);
        double most = 0;
        for (Index t = 0; t < mesh.triangle_count(); ++t) most = std::max(most, deviation_of(mesh.places(t)));
        EXPECT_LE(most, 300);
        EXPECT_EQ(result.deviation_max, most);
        EXPECT_GT(mesh.triangle_count(), 300u);
        EXPECT_EQ(mesh.check(), "");
        for (Index v = 0; v < mesh.vertex_count(); ++v)
            EXPECT_EQ(mesh.place(v).z, surface(mesh.place(v).x, mesh.place(v).y));
    }
    // Under one budget, deviation first ends nearer to the surface.
    double reached[2];
    for (const SplitOrder order : {SplitOrder::length, SplitOrder::deviation}) {
        Bisection mesh = on_surface();
        RefineGoal goal;
        goal.max_triangles = 400;
        goal.deviation = measure;
        goal.order = order;
        const RefineResult result = mesh.refine(goal);
        EXPECT_EQ(result.end, RefineEnd::budget);
        EXPECT_LE(mesh.triangle_count(), 400u);
        EXPECT_GE(mesh.triangle_count(), 399u);
        reached[order == SplitOrder::deviation] = result.deviation_max;
    }
    EXPECT_LT(reached[1], reached[0]);
}

TEST(BisectionGoals, OnlyTheRegionIsRefined) {
    const auto near = [](const TrianglePlaces& p) {
        return length(glm::dvec2(p[0] + p[1] + p[2]) / 3. - glm::dvec2(2e5, 2e5)) < 1e5;
    };
    const PlainMesh base = random_mesh(40, 3, 0);
    Bisection mesh(base);
    RefineGoal goal;
    goal.max_side = 1e4;
    goal.region = near;
    EXPECT_EQ(mesh.refine(goal).end, RefineEnd::met);
    std::size_t fine = 0, coarse = 0;
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
        if (near(mesh.places(t))) {
            EXPECT_LE(mesh.side_length(t, 0), 1e4);
        }
        (mesh.side_length(t, 0) <= 1e4 ? fine : coarse) += 1;
    }
    EXPECT_GT(fine, 500u);
    EXPECT_GT(coarse, 50u);
    EXPECT_GT(mesh.report().propagation_max, 0u);
    EXPECT_EQ(conforming(mesh.mesh(), base), "");
    const std::size_t before = mesh.triangle_count();
    mesh.step([](const TrianglePlaces& p) { return p[0].x > 9e5; });
    EXPECT_GT(mesh.triangle_count(), before);
    EXPECT_LT(mesh.triangle_count(), before + before / 2);
}

TEST(BisectionGoals, ASphereIsRefinedUntilItsPlacedSidesAreShort) {
    BisectionOptions options;
    options.place = [](const glm::dvec3& a, const glm::dvec3& b) { return normalize(a + b); };
    Bisection mesh(octahedron(), options);
    RefineGoal goal;
    goal.max_side = 0.1;
    EXPECT_EQ(mesh.refine(goal).end, RefineEnd::met);
    EXPECT_LE(longest_side(mesh.mesh()), 0.1);
    EXPECT_LE(mesh.report().side_max_placed, 0.1);
    for (Index v = 0; v < mesh.vertex_count(); ++v) EXPECT_NEAR(length(mesh.place(v)), 1, 1e-15);
    EXPECT_EQ(mesh.triangle_count(), 2 * mesh.vertex_count() - 4) << "closed";
    EXPECT_EQ(mesh.check(), "");
}

TEST(BisectionGoals, ASplitAtAPointSplitsTheNearestSide) {
    const PlainMesh base = one_triangle(0.7, 0.5);
    Bisection mesh(base);
    const auto shortest = mesh.nearest_side({0.86, 0.2});
    ASSERT_TRUE(shortest);
    EXPECT_EQ(mesh.split_side(*shortest), 2u) << "AB first";
    bool middle = false;
    for (Index v = 0; v < mesh.vertex_count(); ++v) middle |= mesh.place(v) == glm::dvec3(0.85, 0.25, 0);
    EXPECT_TRUE(middle);
    EXPECT_FALSE(mesh.nearest_side({0, 1}));
    EXPECT_FALSE(mesh.nearest_side({NAN, 1}));
}

TEST(BisectionGoals, MemoryStaysWithin120BytesATriangle) {
    Bisection mesh(random_mesh(5000, 2, 0));
    RefineGoal goal;
    goal.max_triangles = 300'000;
    mesh.refine(goal);
    EXPECT_LE(static_cast<double>(mesh.bytes()) / static_cast<double>(mesh.triangle_count()), 120);
}

TEST(BisectionGoals, SidesThatNoDoubleCanHalveAreLeftAlone) {
    Bisection mesh(one_triangle(0.7, 0.5));
    Index t = 0;
    std::size_t splits = 0;
    while (mesh.split(t) != 0 && splits < 10'000) {
        ++splits;
        t = static_cast<Index>(mesh.triangle_count() - 1);
    }
    EXPECT_LT(splits, 1000u);
    EXPECT_GT(splits, 40u);
    EXPECT_EQ(mesh.split_side({t, 1}), 0u);
    RefineGoal goal;
    goal.max_side = 1e-30;
    goal.region = [&](const TrianglePlaces& p) { return std::min({length(p[0]), length(p[1]), length(p[2])}) == 0; };
    Bisection other(one_triangle(0.7, 0.5));
    EXPECT_EQ(other.refine(goal).end, RefineEnd::finest);
}

TEST(BisectionGoals, SenselessGoalsAreRefused) {
    Bisection mesh(octahedron());
    const auto refused = [&](auto change) {
        RefineGoal goal;
        change(goal);
        try {
            mesh.refine(goal);
        } catch (const Error& e) {
            return e.fault() == Fault::bad_usage && std::string(e.what()).find('\n') == std::string::npos;
        }
        return false;
    };
    EXPECT_TRUE(refused([](RefineGoal&) {}));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_side = 0; }));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_side = NAN; }));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_deviation = 1; }));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_deviation = -1, g.deviation = measure; }));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_triangles = 7; }));
    EXPECT_TRUE(refused([](RefineGoal& g) { g.max_triangles = 20, g.order = SplitOrder::deviation; }));
    EXPECT_EQ(mesh.triangle_count(), 8u);
}

TEST(BisectionGoals, MeshesThatAreNoneAreRefusedInOneLine) {
    const auto message = [](const PlainMesh& mesh, SideGeometry sides = SideGeometry::space) -> std::string {
        try {
            Bisection none(mesh, {BisectionRule::modified, sides, {}});
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            return e.what();
        }
        return "accepted";
    };
    const std::vector<glm::dvec3> places = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {2, 0, 0}};
    EXPECT_EQ(message({places, {{0, 1, 2}, {1, 4, 2}}}), "accepted");
    EXPECT_NE(message({places, {}}).find("no triangles"), std::string::npos);
    EXPECT_NE(message({{}, {}}).find("no triangles"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 6}}}).find("vertex 6"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 2}, {1, 1, 2}}}).find("triangle 1"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 5}}}).find("no area"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 3}}}, SideGeometry::plan).find("no area in plan"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 2}, {0, 1, 3}}}).find("turn unlike"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}).find("more than two"), std::string::npos);
    EXPECT_NE(message({places, {{0, 1, 2}, {1, 0, 2}}}).find("same three vertices"), std::string::npos);
    for (const double bad : {std::nan(""), 1e300, -HUGE_VAL}) {
        PlainMesh mesh{places, {{0, 1, 2}}};
        mesh.vertices[1].y = bad;
        EXPECT_NE(message(mesh).find("vertex 1"), std::string::npos);
    }
    PlainMesh mesh{places, {{0, 1, 2}}};
    mesh.attribute_width = 3;
    EXPECT_NE(message(mesh), "accepted");
}

}  // namespace
}  // namespace planet
