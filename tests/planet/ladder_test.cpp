#include "planet/store/ladder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace planet {
namespace {

unsigned code_by_search(float deviation) {
    const auto& steps = deviation_steps();
    return static_cast<unsigned>(std::lower_bound(steps.begin(), steps.end() - 1, deviation) - steps.begin());
}

TEST(Ladder, ADeviationGetsTheLeastStepThatHoldsIt) {
    for (unsigned c = 0; c < deviation_codes; ++c) {
        const float step = deviation_from_code(c);
        EXPECT_EQ(deviation_code(step), c);
        EXPECT_EQ(deviation_code(std::nextafter(step, 1e30f)), std::min(c + 1, deviation_codes - 1u)) << c;
    }
    for (float d = 1e-12f; d < 1e13f; d *= 1.0007f) ASSERT_EQ(deviation_code(d), code_by_search(d)) << d;
    for (std::uint32_t bits = 0; bits < 0x7f800000u; bits += 0x1fff) {
        const float d = std::bit_cast<float>(bits);
        ASSERT_EQ(deviation_code(d), code_by_search(d)) << d;
    }
    EXPECT_EQ(deviation_code(0), 0u);
    EXPECT_EQ(deviation_code(std::numeric_limits<float>::max()), deviation_codes - 1);
}

TEST(Ladder, StepsAreTwelveAnOctaveFromACentimetre) {
    EXPECT_FLOAT_EQ(deviation_from_code(1), 0.01f);
    for (unsigned c = 1; c + 12 < deviation_codes; ++c)
        EXPECT_FLOAT_EQ(deviation_from_code(c + 12), 2 * deviation_from_code(c));
}

}  // namespace
}  // namespace planet
