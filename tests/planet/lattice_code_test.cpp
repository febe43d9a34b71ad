#include "planet/store/lattice_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planet/mesh/tile_layout.h"
#include "planet/store/rice_code.h"

namespace planet {
namespace {

std::size_t vertices(int depth) {
    return tile_layout().vertex_count[static_cast<std::size_t>(depth)];
}

std::vector<std::uint8_t> written(std::span<const std::int32_t> q) {
    ByteWriter out;
    write_lattice(out, q);
    return out.bytes();
}

TEST(LatticeCode, WhatIsWrittenIsReadAtEveryDepth) {
    std::mt19937 random(1);
    for (int depth = 1; depth <= tile_levels; ++depth)
        for (const std::int32_t size : {0, 1, 40, 5000, largest_height_quanta}) {
            std::uniform_int_distribution<std::int32_t> uniform(-size, size);
            std::vector<std::int32_t> q(vertices(depth)), read(q.size());
            for (std::int32_t& v : q) v = uniform(random);
            q[1] = size;
            q.back() = -size;
            auto bytes = written(q);
            bytes.push_back(99);
            ByteReader in(bytes);
            read_lattice(in, read);
            ASSERT_EQ(read, q) << depth << " " << size;
            EXPECT_EQ(in.u8(), 99);  // the reader goes on behind it
        }
}

TEST(LatticeCode, ALinearSurfaceTakesAlmostNothing) {
    std::vector<std::int32_t> q(vertices(12));
    for (std::size_t v = 0; v < q.size(); ++v) {
        const auto [x, y] = tile_layout().lattice[v];
        q[v] = 64 * x - 192 * y + 1000;
    }
    EXPECT_LT(written(q).size(), q.size() / 8 + 24);  // one bit a vertex is the least of a Rice code
}

// The corners of diamonds on the tile's border are predicted from the two ends alone, the others from all four: a saddle
// is flat for these.
TEST(LatticeCode, InteriorVerticesArePredictedFromFourCorners) {
    std::vector<std::int32_t> q(vertices(12));
    for (std::size_t v = 0; v < q.size(); ++v) {
        const auto [x, y] = tile_layout().lattice[v];
        q[v] = 16 * (x - y) * (x - y) - 16 * (x + y) * (x + y);
    }
    const std::size_t saddle = written(q).size();
    for (std::size_t v = 0; v < q.size(); ++v) {
        const auto [x, y] = tile_layout().lattice[v];
        q[v] = 16 * (x - y) * (x - y) + 16 * (x + y) * (x + y);
    }
    EXPECT_LT(2 * saddle, written(q).size());
}

TEST(LatticeCode, OutOfRangeIsMalformed) {
    const std::vector<std::int32_t> flat(vertices(2), largest_height_quanta);
    auto bytes = written(flat);
    std::vector<std::int32_t> read(flat.size());
    // One more than the largest, in a corner and then in a vertex.
    for (const std::int64_t beyond : {std::int64_t{largest_height_quanta} + 1, -std::int64_t{largest_height_quanta} - 1,
                                      std::int64_t{INT32_MAX} + 5, INT64_MIN}) {
        ByteWriter out;
        for (int k = 0; k < 3; ++k) out.varint(zigzag(beyond));
        { RiceWriter(out).group(std::vector<std::uint32_t>(flat.size() - 3, 0)); }
        ByteReader in(out.bytes());
        EXPECT_THROW(read_lattice(in, read), MalformedBytes);
    }
    for (const std::uint32_t residual : {2u, UINT32_MAX, UINT32_MAX - 1, 1u << 31}) {
        ByteWriter out;
        for (int k = 0; k < 3; ++k) out.varint(zigzag(largest_height_quanta));
        {
            RiceWriter rice(out);
            rice.group(std::vector<std::uint32_t>{residual});
            rice.group(std::vector<std::uint32_t>(2, 0));
        }
        ByteReader in(out.bytes());
        EXPECT_THROW(read_lattice(in, read), MalformedBytes) << residual;
    }
}

TEST(LatticeCode, CutShortIsMalformedAtAnyLength) {
    std::mt19937 random(4);
    std::vector<std::int32_t> q(vertices(7)), read(q.size());
    for (std::int32_t& v : q) v = static_cast<std::int32_t>(random() % 2000);
    const auto bytes = written(q);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        ByteReader in({bytes.data(), size});
        EXPECT_THROW(read_lattice(in, read), MalformedBytes) << size;
    }
}

}  // namespace
}  // namespace planet
