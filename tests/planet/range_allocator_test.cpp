#include "planet/mesh/range_allocator.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace planet {
namespace {

TEST(RangeAllocator, FillsTheSmallestHoleAndJoinsNeighbours) {
    RangeAllocator places;
    const Range a = places.allocate(10), b = places.allocate(5), c = places.allocate(20), d = places.allocate(1);
    EXPECT_EQ(d, (Range{35, 1}));
    places.free(a);
    places.free(c);
    EXPECT_EQ(places.allocate(9), (Range{0, 9}));
    EXPECT_EQ(places.allocate(9), (Range{15, 9}));
    places.free({0, 9});
    places.free(b);  // 0 .. 15
    EXPECT_EQ(places.allocate(15), (Range{0, 15}));
    EXPECT_EQ(places.size(), 36u);
    places.free(d);
    EXPECT_EQ(places.size(), 24u);  // what is free at the end is given up, with the hole before it
    EXPECT_EQ(places.allocate(0), (Range{0, 0}));
    places.clear();
    EXPECT_EQ(places.size(), 0u);
    EXPECT_EQ(places.allocate(3), (Range{0, 3}));
}

TEST(RangeAllocator, NeverGivesAnElementTwice) {
    RangeAllocator places;
    std::mt19937 random(1);
    std::vector<Range> held;
    std::vector<int> owner;
    std::size_t in_use = 0, most = 0;
    for (int step = 0; step < 20000; ++step) {
        if (held.empty() || random() % 100 < 50) {
            const Range r = places.allocate(static_cast<std::uint32_t>(1 + random() % 300));
            ASSERT_LE(r.first + r.count, places.size());
            owner.resize(std::max<std::size_t>(owner.size(), places.size()));
            for (std::uint32_t i = r.first; i < r.first + r.count; ++i) ASSERT_EQ(owner[i]++, 0);
            held.push_back(r);
            in_use += r.count;
            most = std::max(most, in_use);
        } else {
            const std::size_t k = random() % held.size();
            for (std::uint32_t i = held[k].first; i < held[k].first + held[k].count; ++i) --owner[i];
            in_use -= held[k].count;
            places.free(held[k]);
            held[k] = held.back();
            held.pop_back();
        }
    }
    EXPECT_LT(owner.size(), most * 3 / 2);
    for (const Range& r : held) places.free(r);
    EXPECT_EQ(places.size(), 0u);
}

}  // namespace
}  // namespace planet
