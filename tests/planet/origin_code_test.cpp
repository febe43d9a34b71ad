// Origins of a tile's heights: in memory, and as bytes.

#include "planet/store/origin_code.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "planet/mesh/tile_layout.h"

namespace planet {
namespace {

HeightOrigin only(std::uint32_t file) {
    return {file, file};
}

OriginPlane round_trip(const OriginPlane& plane, std::size_t vertices, std::uint32_t files) {
    ByteWriter out;
    write_origins(out, plane);
    ByteReader in(out.bytes());
    OriginPlane back = read_origins(in, plane.kinds().size() > 1, vertices, files);
    EXPECT_TRUE(in.at_end());
    return back;
}

std::vector<WeighedOrigin> random_origins(std::size_t count, std::uint32_t files, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<WeighedOrigin> origins(count);
    for (WeighedOrigin& o : origins) {
        o.origin = only(static_cast<std::uint32_t>(random() % (files + 1)));
        if (random() % 3 == 0) o.origin.other = static_cast<std::uint32_t>(random() % (files + 1));
    }
    return origins;
}

TEST(OriginPlane, KeepsWhatItIsMadeOf) {
    EXPECT_FALSE(OriginPlane().known());
    for (const std::uint32_t files : {0u, 1u, 7u, 5000u})
        for (const std::size_t count : {std::size_t{4}, std::size_t{6}, std::size_t{tile_vertices}}) {
            const auto origins = random_origins(count, files, files);
            const OriginPlane plane(origins), back = round_trip(plane, count, files);
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(plane[i], origins[i].origin);
                ASSERT_EQ(back[i], origins[i].origin);
            }
        }
}

TEST(OriginPlane, IsAByteWhereAllIsFromOneFile) {
    const std::vector<WeighedOrigin> origins(tile_vertices, WeighedOrigin{only(3), 1});
    const OriginPlane plane(origins);
    EXPECT_TRUE(plane.kind().empty());
    ByteWriter out;
    write_origins(out, plane);
    EXPECT_EQ(out.bytes().size(), 1u);
}

// Two halves with a straight border: about a byte or two for each of the vertices at it, not for all.
TEST(OriginPlane, IsSmallAlongABorder) {
    std::vector<WeighedOrigin> origins(tile_vertices);
    for (std::size_t v = 0; v < origins.size(); ++v) origins[v].origin = only(tile_layout().lattice[v][0] < 20 ? 1 : 2);
    ByteWriter out;
    write_origins(out, OriginPlane(origins));
    EXPECT_LT(out.bytes().size(), 350u);
}

TEST(OriginPlane, RefusesWhatIsNone) {
    const auto refuses = [](std::initializer_list<std::uint64_t> numbers, bool several, std::size_t vertices) {
        ByteWriter out;
        for (const std::uint64_t n : numbers) out.varint(n);
        ByteReader in(out.bytes());
        EXPECT_THROW(read_origins(in, several, vertices, 2), MalformedBytes);
    };
    refuses({}, false, 4);                 // ends early
    refuses({6}, false, 4);                // of file 3
    refuses({2 * 1 + 1, 3}, false, 4);     // blended with file 3
    refuses({2 * 1 + 1, 1}, false, 4);     // blended with itself
    refuses({1, 2}, true, 4);              // several, but one
    refuses({5, 0, 2, 4, 3, 5}, true, 4);  // more kinds than vertices
    refuses({2, 2, 4, 5}, true, 4);        // goes on beyond the end
    refuses({2, 2, 4, 1, 2, 2}, true, 4);  // a kind that is not listed
    refuses({2, 2, 4, 1}, true, 4);        // ends early
}

}  // namespace
}  // namespace planet
