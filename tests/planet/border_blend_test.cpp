#include "planet/elevation/border_blend.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "planet/frames.h"

namespace planet {
namespace {

glm::dvec3 at(double x, double y) {
    return normal_from_geodetic((40 + y) * degrees, (10 + x) * degrees);
}

struct ScatteredBlend {
    std::mt19937 random{1};
    std::vector<BorderBlend::Point> points;

    explicit ScatteredBlend(std::size_t count) {
        std::uniform_real_distribution<double> place(0, 0.2), reach(0.0005, 0.002), difference(-20, 20);
        for (std::size_t k = 0; k < count; ++k)
            points.push_back({at(place(random), place(random)), difference(random), reach(random),
                              1.0f + static_cast<float>(k % 3), static_cast<std::uint32_t>(k)});
    }

    // By the formula, point by point.
    double exactly(const glm::dvec3& p, double clearance) const {
        double least = 1, weights = 0, total = 0;
        for (const auto& q : points) {
            const double r = glm::distance(p, q.normal), D = q.reach + clearance;
            least = std::min(least, std::max(0.0, r - clearance) / q.reach);
            if (r >= D) continue;
            const double w = static_cast<double>(q.count) * std::pow((D - r) / (D * r), 2);
            weights += w;
            total += w * q.difference;
        }
        return least < 1 ? std::pow(1 - least, 2) * (1 + 2 * least) * total / weights : 0;
    }
};

TEST(BorderBlend, IsTheFormulaUpToItsClusters) {
    const ScatteredBlend few(60);
    const BorderBlend blend(few.points, 1e-5);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-0.3, 0.5);
    std::size_t changed = 0;
    for (int k = 0; k < 2000; ++k) {
        const glm::dvec3 p = at(place(random), place(random));
        const double exact = few.exactly(p, 1e-5);
        ASSERT_NEAR(blend(p), exact, 0.5) << k;
        changed += exact != 0 ? 1 : 0;
    }
    EXPECT_GT(changed, 300u);
    EXPECT_LT(changed, 1900u);
}

TEST(BorderBlend, PlacesTogetherGetTheBitsTheyGetAlone) {
    ScatteredBlend many(3000);
    const BorderBlend blend(many.points, 1e-5);
    std::uniform_real_distribution<double> place(-0.3, 0.5), near(-0.004, 0.004);
    std::vector<glm::dvec3> normals;
    for (int k = 0; k < 300; ++k) {
        const double x = place(many.random), y = place(many.random);
        for (int i = 0; i < 11; ++i) normals.push_back(at(x + near(many.random), y + near(many.random)));
    }
    normals[77] = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    normals[200] = many.points[5].normal;
    normals[201] = -normals[200];
    std::vector<double> corrections(normals.size(), 3.0);
    blend.add(normals, corrections);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(3.0 + blend(normals[i])), std::bit_cast<std::uint64_t>(corrections[i]))
            << i;
        changed += corrections[i] != 3 ? 1 : 0;
    }
    EXPECT_EQ(corrections[77], 3.0);
    EXPECT_GT(changed, 200u);
    EXPECT_LT(changed, 2000u);
}

// The weight is the smooth step of the least distance / reach, and the file that point's.
TEST(BorderBlend, SaysWhoseBorderIsNearest) {
    constexpr double clearance = 1e-5;
    ScatteredBlend some(3000);
    const BorderBlend blend(some.points, clearance);
    std::uniform_real_distribution<double> place(-0.01, 0.21);
    std::size_t shared = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 p = at(place(some.random), place(some.random));
        double least = 1, correction = 0;
        std::uint32_t file = 0;
        for (const auto& q : some.points) {
            const double ratio = (glm::distance(p, q.normal) - clearance) / q.reach;
            if (ratio >= least) continue;
            least = ratio;
            file = q.file;
        }
        BorderShare share{-1, 77};
        blend.add({&p, 1}, {&correction, 1}, {&share, 1});
        const double s = 1 - std::max(0.0, least);
        EXPECT_NEAR(share.weight, least < 1 ? s * s * (3 - 2 * s) : -1, 1e-9);
        EXPECT_EQ(share.file, least < 1 ? file : 77u);
        shared += least < 1;
    }
    EXPECT_GT(shared, 500u);
}

TEST(BorderBlend, WithoutPointsChangesNothing) {
    double correction = 2;
    const glm::dvec3 p = at(0, 0);
    BorderBlend().add({&p, 1}, {&correction, 1});
    EXPECT_EQ(correction, 2);
}

}  // namespace
}  // namespace planet
