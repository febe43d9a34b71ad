#include "planet/bake/packed_heights.h"

#include <gtest/gtest.h>

#include <random>

namespace planet {
namespace {

TEST(PackedHeights, AreTheSameAgainInTwoBytesOrFour) {
    std::mt19937 random(1);
    for (const double quantum : {1.0 / 256, 0.25, 1.0, 64.0})
        for (const int steps : {0, 1, 65535, 65536, 4000000})
            for (const std::size_t count : {1u, 3u, 15u, 16u, 17u, 1089u}) {
                std::uniform_int_distribution<int> step(-steps / 2, steps - steps / 2);
                std::vector<float> heights;
                for (std::size_t v = 0; v < count; ++v) heights.push_back(static_cast<float>(step(random) * quantum));
                heights.front() = static_cast<float>(-(steps / 2) * quantum);
                heights.back() = static_cast<float>((steps - steps / 2) * quantum);
                const PackedHeights packed(heights, quantum);
                EXPECT_EQ(packed.size(), count);
                EXPECT_EQ(packed.bytes(), count * (count > 1 && steps > 65535 ? 4 : 2)) << steps;
                std::vector<float> again(7, 1.0f);
                packed.unpack(again);
                EXPECT_EQ(again, heights);
            }
}

TEST(PackedHeights, NoneAreNone) {
    std::vector<float> again(3);
    PackedHeights({}, 0.25).unpack(again);
    EXPECT_TRUE(again.empty());
}

}  // namespace
}  // namespace planet
