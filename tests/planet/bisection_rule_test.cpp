// Both rules: conforming after every split, angles, propagation, ties.

#include <gtest/gtest.h>

#include "bisection_meshes.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr double modified_bound = 0.673408;  // arctan(sqrt(7) / 5) / arccos(3 / 4), cut off

constexpr BisectionRule rules[] = {BisectionRule::modified, BisectionRule::plain};

std::vector<std::pair<const char*, PlainMesh>> all_kinds() {
    return {{"triangle", one_triangle(0.7, 0.4)},
            {"random", random_mesh(60, 1, 0)},
            {"relief", random_mesh(60, 2, 300)},
            {"squares", halved_squares(3, 3)},
            {"inexact squares", halved_squares(5, 4, 1. / 1200, {-105.1, 37.3})},
            {"hexagon", hexagon()},
            {"octahedron", octahedron()},
            {"tetrahedron", tetrahedron(3)}};
}

TEST(BisectionRule, RandomSplitsLeaveAConformingMeshEveryTime) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : all_kinds()) {
            SCOPED_TRACE(name);
            Bisection mesh(base, {rule});
            std::mt19937 random(7);
            for (int i = 0; i < 400; ++i) {
                const auto t = static_cast<std::uint32_t>(random() % mesh.triangle_count());
                const int side = static_cast<int>(random() % 3);
                const std::size_t before = mesh.vertex_count();
                const std::size_t splits = i % 3 == 0 ? mesh.split_side({t, side}) : mesh.split(t);
                ASSERT_GE(splits, 1u);
                ASSERT_EQ(mesh.vertex_count(), before + splits);
                ASSERT_EQ(mesh.check(), "") << "after split " << i;
                if (i % 20 == 0) {
                    ASSERT_EQ(conforming(mesh.mesh(), base), "");
                }
            }
            EXPECT_EQ(conforming(mesh.mesh(), base), "");
            EXPECT_NEAR(area(mesh.mesh()), area(base), 1e-9 * area(base));
        }
}

TEST(BisectionRule, NoAngleOfACompleteLeafFallsBelowTheBound) {
    double worst[2] = {1, 1}, worst_pending = 1;
    std::mt19937 random(11);
    for (int i = 0; i < 100'000; ++i) {
        const glm::dvec2 c = random_apex(random);
        for (const BisectionRule rule : rules) {
            Bisection mesh(one_triangle(c.x, c.y), {rule});
            // Down one path at random, so that the tree is deep; then a step, so that most pending leaves complete.
            for (int k = 0; k < 12; ++k) mesh.split(static_cast<std::uint32_t>(random() % mesh.triangle_count()));
            const BisectionReport r = mesh.report();
            const auto which = static_cast<std::size_t>(rule == BisectionRule::plain);
            worst[which] = std::min(worst[which], r.angle_ratio_min);
            worst_pending = std::min(worst_pending, r.angle_ratio_min_pending);
            if (rule == BisectionRule::plain) {
                ASSERT_EQ(r.pending_triangles, 0u);
            }
        }
    }
    EXPECT_GE(worst[0], modified_bound);
    EXPECT_LE(worst[0], 0.69) << "the bound is sharp: shapes near it must have been met";
    EXPECT_GE(worst[1], 0.5);
    EXPECT_LE(worst[1], 0.51);
    EXPECT_GE(worst_pending, 0.5);
    EXPECT_LE(worst_pending, 0.6);
}

TEST(BisectionRule, LongestFirstNeverPropagates) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : all_kinds()) {
            SCOPED_TRACE(name);
            Bisection mesh(base, {rule});
            RefineGoal goal;
            goal.max_triangles = 3000;
            const RefineResult result = mesh.refine(goal);
            EXPECT_EQ(result.end, RefineEnd::budget);
            EXPECT_LE(mesh.triangle_count(), 3000u);
            EXPECT_GE(mesh.triangle_count(), 2999u);
            const BisectionReport r = mesh.report();
            EXPECT_EQ(r.propagation_max, 0u);
            EXPECT_EQ(r.propagation_mean, 0);
            EXPECT_EQ(mesh.check(), "");
            EXPECT_EQ(conforming(mesh.mesh(), base), "");
            if (rule == BisectionRule::modified) {
                EXPECT_GE(r.angle_ratio_min, modified_bound);
            }
            EXPECT_GE(std::min(r.angle_ratio_min, r.angle_ratio_min_pending), 0.5 - 1e-9);
        }
}

// Of a triangle with |BC| = |CC'| one half is split long before the other, and its quarter waits for its turn with a side on
// the border: nothing is beyond it that could be fetched ahead.
TEST(BisectionRule, QuartersAtTheBorderWaitTheirTurn) {
    for (const double x : {0.749, 0.75, 0.751}) {
        const PlainMesh base = one_triangle(x, 0.5);
        Bisection mesh(base);
        RefineGoal goal;
        goal.max_triangles = 3000;
        mesh.refine(goal);
        EXPECT_GE(mesh.triangle_count(), 2999u);
        EXPECT_EQ(mesh.check(), "");
        EXPECT_EQ(conforming(mesh.mesh(), base), "");
    }
}

}  // namespace
}  // namespace planet
