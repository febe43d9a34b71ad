// Both sides of every side that two triangles share are the same bits, as the vertex shader of pictures puts them out:
// what transform feedback brings back makes a closed surface by bits alone, without any knowledge of which vertices are
// meant to be the same. Every directed side has its reverse, borders of segments included.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <unordered_map>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"
#include "tests/render/app/vertex_capture.h"

namespace render {
namespace {

using namespace testing;

using DecodedVertex = std::array<std::uint32_t, 7>;  ///< a CapturedVertex as bits

struct BitHash {
    std::size_t operator()(const DecodedVertex& v) const {
        std::uint64_t h = 0;
        for (const std::uint32_t word : v) h = (h ^ word) * 0x9e3779b97f4a7c15u ^ h >> 29;
        return h;
    }
};

struct Seams {
    std::size_t open = 0;      ///< directed sides without their reverse
    std::size_t border = 0;    ///< sides between two segments, closed
    std::size_t vertices = 0;  ///< different ones on those
};

Seams seams_of(const std::vector<SegmentTriangle>& triangles, const std::vector<DecodedVertex>& decoded) {
    struct Side {
        std::uint64_t ends;  // numbers of the bits, from and to
        std::uint32_t segment;
    };
    std::unordered_map<DecodedVertex, std::uint32_t, BitHash> numbers;
    std::vector<Side> sides, reversed;
    for (const SegmentTriangle& t : triangles) {
        std::uint64_t n[3];
        for (std::size_t k = 0; k < 3; ++k)
            n[k] = numbers.try_emplace(decoded[t.vertex[k]], static_cast<std::uint32_t>(numbers.size())).first->second;
        // Far away vertices can fall together; a triangle of two such vertices has no area, and its sides cancel.
        for (std::size_t k = 0; k < 3; ++k) {
            sides.push_back({n[k] << 32 | n[(k + 1) % 3], t.segment});
            reversed.push_back({n[(k + 1) % 3] << 32 | n[k], t.segment});
        }
    }
    const auto less = [](const Side& a, const Side& b) {
        return std::pair(a.ends, a.segment) < std::pair(b.ends, b.segment);
    };
    std::sort(sides.begin(), sides.end(), less);
    std::sort(reversed.begin(), reversed.end(), less);
    Seams seams;
    std::vector<std::uint64_t> at_border;
    auto other = reversed.begin();
    for (const Side& side : sides) {
        while (other != reversed.end() && other->ends < side.ends) ++other, ++seams.open;
        if (other == reversed.end() || other->ends != side.ends) {
            ++seams.open;
            continue;
        }
        if (other->segment != side.segment) {
            ++seams.border;
            at_border.push_back(side.ends >> 32);
        }
        ++other;
    }
    seams.open += static_cast<std::size_t>(reversed.end() - other);
    seams.border /= 2;
    std::sort(at_border.begin(), at_border.end());
    seams.vertices = static_cast<std::size_t>(std::unique(at_border.begin(), at_border.end()) - at_border.begin());
    return seams;
}

using SeamBits = DrawnEarth;

TEST_F(SeamBits, AreTheSameOnBothSides) {
    constexpr std::size_t count = 8;  // for each exaggeration
    VertexCapture capture;
    planet::Segments segments;
    std::size_t border = 0, vertices = 0;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth earth(store_, exaggeration);
        EarthViews views(1920, 1080, 7);
        for (std::size_t i = 0; i < count; ++i) {
            const EarthView view = views.next(earth);
            segments.build(earth.tiles(), whole_planet_view(view.camera, earth.ball(), 4), 2);
            const Seams seams =
                seams_of(triangles_of(segments), capture.decode<DecodedVertex>(segments.vertices(), view.camera));
            EXPECT_EQ(seams.open, 0u) << "view " << i << ", exaggeration " << exaggeration;
            EXPECT_GT(seams.border, 0u) << "view " << i << ", exaggeration " << exaggeration;
            border += seams.border;
            vertices += seams.vertices;
        }
    }
    EXPECT_GT(border, 500000u);
    EXPECT_GT(vertices, 250000u);
}

// One vertex of one segment that is off by the least step opens sides.
TEST_F(SeamBits, AreSeenToDiffer) {
    const ExaggeratedEarth earth(store_, 1);
    const glm::dvec3 normal = planet::normal_from_geodetic(37.6 * degrees, -105.4 * degrees);
    const Camera camera = make_camera(planet::ecef_from_normal(wgs84, normal, {earth.ground(normal) + 20}), normal, 0,
                                      0, 1000, 1920, 1080);
    planet::Segments segments;
    segments.build(earth.tiles(), whole_planet_view(camera, earth.ball(), 8), 2);
    std::vector<planet::SegmentVertex> vertices(segments.vertices().begin(), segments.vertices().end());
    VertexCapture capture;
    const auto triangles = triangles_of(segments);
    ASSERT_EQ(seams_of(triangles, capture.decode<DecodedVertex>(vertices, camera)).open, 0u);
    const auto distance = [&](const planet::SegmentVertex& v) {
        return glm::distance(planet::ecef_from_grid(v.position), camera.eye);
    };
    const auto nearest = std::min_element(vertices.begin(), vertices.end(),
                                          [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    const float at = static_cast<float>(distance(*nearest));
    // The least step that the shader's rounding keeps at that distance: 2^-23 of it at most, in steps of 2^-18 m.
    const auto step = static_cast<std::uint32_t>(std::max(1.0f, std::ceil(at * 0x1p-23f * 0x1p18f)));
    nearest->position.low ^= std::bit_ceil(step);
    EXPECT_GT(seams_of(triangles, capture.decode<DecodedVertex>(vertices, camera)).open, 0u)
        << at << " m away, " << step << " steps";
}

}  // namespace
}  // namespace render
