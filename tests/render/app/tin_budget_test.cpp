// The search for the tolerance of a budget, over curves of triangles that are known.

#include "render/app/tin/tin_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace render {
namespace {

std::size_t power(double tolerance, double scale, double exponent) {
    return 32 + static_cast<std::size_t>(std::min(1e7, scale / std::pow(tolerance, exponent)));
}

TEST(TinBudget, IsMetWithinAHundredth) {
    for (const double exponent : {1.0, 1.3, 2.0, 3.0})
        for (const double scale : {1e3, 1e6, 1e9})
            for (const std::size_t budget : {100u, 5000u, 3'000'000u}) {
                int calls = 0;
                const BudgetFit fit = fit_to_budget(
                    [&](double t) {
                        ++calls;
                        return power(t, scale, exponent);
                    },
                    budget, 0, 1e10);
                EXPECT_EQ(fit.triangles, power(fit.tolerance, scale, exponent));
                EXPECT_LE(fit.triangles, budget);
                EXPECT_GE(fit.triangles, 0.99 * static_cast<double>(budget)) << exponent << ' ' << scale;
                EXPECT_EQ(fit.trials, calls);
                EXPECT_LE(calls, 12);
            }
}

TEST(TinBudget, TakesWhatStepsLeave) {
    // Nothing lies between 40 and 1000 triangles.
    const auto steps = [](double t) { return std::size_t{t < 5 ? 1000u : 40u}; };
    EXPECT_EQ(fit_to_budget(steps, 999, 0, 1e7).triangles, 40u);
    EXPECT_EQ(fit_to_budget(steps, 40, 0, 1e7).triangles, 40u);
    const BudgetFit all = fit_to_budget(steps, 5000, 0, 1e7);
    EXPECT_EQ(all.triangles, 1000u);
    EXPECT_LE(all.trials, 12);
}

TEST(TinBudget, SaysWhatIsLeastWhereNothingFits) {
    const BudgetFit fit = fit_to_budget([](double) { return std::size_t{40}; }, 39, 0, 1e7);
    EXPECT_EQ(fit.triangles, 40u);
    EXPECT_EQ(fit.trials, 1);
}

TEST(TinBudget, StaysAboveTheBound) {
    std::vector<double> tried;
    const BudgetFit fit = fit_to_budget(
        [&](double t) {
            tried.push_back(t);
            return power(t, 1e6, 1.3);
        },
        5000, 50, 1e7);
    EXPECT_GE(fit.triangles, 4950u);
    for (const double t : tried) EXPECT_GE(t, 50);
}

}  // namespace
}  // namespace render
