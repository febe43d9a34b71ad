// Both sides of every side that two triangles share are the same bits, as the vertex shader of pictures puts them out:
// what transform feedback brings back makes a closed surface by bits alone, without any knowledge of which vertices are
// meant to be the same. Every directed side has its reverse, borders of segments included.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <unordered_map>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/seams.h"
#include "tests/render/app/vertex_capture.h"

namespace render {
namespace {

using namespace testing;

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
