#include "planet/store/rice_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace planet {
namespace {

TEST(StoreRice, WhatIsWrittenIsRead) {
    std::mt19937_64 random(1);
    std::vector<std::vector<std::uint32_t>> groups{{}, {0}, {UINT32_MAX}, {0, 0, 0, UINT32_MAX, 1}};
    for (int bits = 0; bits <= 32; ++bits) {
        groups.emplace_back();
        for (int i = 0; i < 50; ++i)
            groups.back().push_back(static_cast<std::uint32_t>(random() & ((std::uint64_t{1} << bits) - 1)));
    }
    ByteWriter out;
    out.u8(7);
    {
        RiceWriter rice(out);
        for (const auto& g : groups) rice.group(g);
    }
    out.varint(300);
    ByteReader in(out.bytes());
    EXPECT_EQ(in.u8(), 7);
    {
        RiceReader rice(in);
        for (const auto& g : groups) {
            std::vector<std::uint32_t> read(g.size());
            rice.group(read);
            EXPECT_EQ(read, g);
        }
    }
    EXPECT_EQ(in.varint(), 300u);  // the reader goes on behind it
    EXPECT_TRUE(in.at_end());
}

TEST(StoreRice, ReadingPastTheEndIsMalformedAtAnyLength) {
    ByteWriter out;
    {
        RiceWriter rice(out);
        rice.group(std::vector<std::uint32_t>{5, 1000, 3, 70000, UINT32_MAX, 2});
    }
    for (std::size_t size = 0; size < out.bytes().size(); ++size) {
        ByteReader in(std::span(out.bytes()).first(size));
        RiceReader rice(in);
        std::vector<std::uint32_t> read(6);
        EXPECT_THROW(rice.group(read), MalformedBytes) << size;
    }
}

TEST(StoreRice, IsNearTheEntropyOfResiduals) {
    std::mt19937_64 random(2);
    std::exponential_distribution<double> size(1.0);
    std::vector<std::uint32_t> values;
    const double width = 37;
    for (int i = 0; i < 20000; ++i) {
        const double v = std::nearbyint((random() % 2 ? 1 : -1) * width * size(random));
        values.push_back(static_cast<std::uint32_t>(zigzag(static_cast<std::int64_t>(v))));
    }
    ByteWriter out;
    { RiceWriter(out).group(values); }
    const double entropy = std::log2(2 * std::exp(1.0) * width);
    EXPECT_LT(8.0 * static_cast<double>(out.bytes().size()) / 20000, entropy + 0.1);
}

TEST(StoreRice, ZigzagIsOneToOne) {
    EXPECT_EQ(zigzag(0), 0u);
    EXPECT_EQ(zigzag(-1), 1u);
    EXPECT_EQ(zigzag(1), 2u);
    for (const std::int64_t v : {INT64_MIN, INT64_MIN + 1, INT64_C(-7), INT64_C(7), INT64_MAX})
        EXPECT_EQ(unzigzag(zigzag(v)), v);
}

}  // namespace
}  // namespace planet
