#include "render/app/time_left.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render {
namespace {

TEST(TimeLeft, IsRightForAnEvenTask) {
    TimeLeft left;
    double before = 1e9;
    for (double t = 0; t < 100; t += 0.1) {
        const auto told = left.update(t, t / 100);
        EXPECT_EQ(told.has_value(), t >= 2) << t;
        if (!told) continue;
        EXPECT_NEAR(*told, 100 - t, 0.5) << t;
        EXPECT_LE(*told, before + 1e-9) << t;
        before = *told;
    }
}

TEST(TimeLeft, CountsFromWhereAResumedTaskBegan) {
    TimeLeft left;
    std::optional<double> told;
    for (double t = 0; t <= 10; t += 0.1) told = left.update(1000 + t, 0.9 + t / 1000);
    ASSERT_TRUE(told);
    EXPECT_NEAR(*told, 90, 1);
}

TEST(TimeLeft, FollowsAChangeOfPaceWithoutAJump) {
    TimeLeft left;
    std::optional<double> told;
    double fraction = 0, t = 0;
    for (; t < 20; t += 0.1, fraction += 0.1 / 40) told = left.update(t, fraction);
    EXPECT_NEAR(told.value(), 20, 1);
    for (; t < 60; t += 0.1, fraction += 0.1 / 160) {
        const double before = *told;
        told = left.update(t, fraction);
        EXPECT_LT(std::abs(*told - before), 2) << t;
    }
    EXPECT_NEAR(*told, 160 * (1 - fraction), 4);
}

TEST(TimeLeft, SaysNothingOfATaskThatDoesNotMove) {
    TimeLeft left;
    for (double t = 0; t < 30; t += 0.5) EXPECT_FALSE(left.update(t, 0.25)) << t;
    EXPECT_FALSE(left.update(31, 0.25).has_value());
}

TEST(TimeLeft, BeginsAnewWithTheNextTask) {
    TimeLeft left;
    for (double t = 0; t < 10; t += 0.1) left.update(t, t / 10);
    EXPECT_FALSE(left.update(10, 0.01));
    EXPECT_FALSE(left.update(11, 0.02));
    const auto told = left.update(13, 0.04);
    ASSERT_TRUE(told);
    EXPECT_NEAR(*told, 96, 1);
}

TEST(TimeLeft, ReadsAsCoarseAsItIs) {
    EXPECT_EQ(duration_text(0), "1 s");
    EXPECT_EQ(duration_text(8.2), "9 s");
    EXPECT_EQ(duration_text(42), "40 s");
    EXPECT_EQ(duration_text(57), "55 s");
    EXPECT_EQ(duration_text(58), "1 min");
    EXPECT_EQ(duration_text(12 * 60 + 20), "12 min");
    EXPECT_EQ(duration_text(59.6 * 60), "1 h");
    EXPECT_EQ(duration_text(3 * 3600 + 25 * 60), "3 h 20 min");
    EXPECT_EQ(duration_text(60 * 3600), "2 days");
}

}  // namespace
}  // namespace render
