// The terrain pass sends what changed, and what is on the GPU is what a fresh upload would have put there.

#include <gtest/gtest.h>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"
#include "tests/render/app/surface_picture.h"

namespace render {
namespace {

using namespace testing;

constexpr int width = 256, height = 192;

using TerrainUpload = DrawnEarth;

TEST_F(TerrainUpload, FollowsSegments) {
    const ExaggeratedEarth earth(store_, 1);
    SurfacePicture picture(width, height, GL_RGBA32F);
    planet::Segments segments;
    TerrainPass pass;
    const glm::dvec3 normal = planet::normal_from_geodetic(37.5 * degrees, -105.4 * degrees);
    const double ground = earth.ground(normal);
    std::size_t least = std::numeric_limits<std::size_t>::max(), whole_mesh = 0;
    for (int frame = 0; frame < 48; ++frame) {
        // Level, then diving, then turning, then back to where it began.
        const double up = 3000 - 50 * std::min(frame, 24), aside = 1e-5 * std::min(frame % 40, 12);
        const glm::dvec3 place = planet::normal_from_geodetic(37.5 * degrees + aside, -105.4 * degrees);
        const Camera camera =
            make_camera(planet::ecef_from_normal(wgs84, place, {ground + up}), place, 0.1 * std::max(frame - 24, 0),
                        -0.3, focal_length_px(50 * degrees, width, height), width, height);
        segments.update(earth.tiles(), segment_view(camera, earth.ball()), 2);
        const std::vector<std::int32_t> layers(segments.segments().size(), -1);
        pass.upload(segments, layers);
        if (frame == 0) whole_mesh = pass.sent_bytes();
        least = std::min(least, pass.sent_bytes());
        const auto strips = [&] {
            for (const planet::Segment& s : segments.segments())
                gl().DrawElementsBaseVertex(GL_TRIANGLE_STRIP, static_cast<GLsizei>(s.index_count), GL_UNSIGNED_INT,
                                            reinterpret_cast<const void*>(std::size_t{s.first_index} * 4),
                                            static_cast<GLint>(s.first_vertex));
        };
        const auto followed = picture.positions(camera, [&] {
            pass.vertex_array().bind();
            strips();
        });
        const SegmentBuffers fresh(segments);
        ASSERT_EQ(followed, picture.positions(camera, [&] { fresh.draw_strips(segments.segments()); }))
            << "frame " << frame;

        segments.update(earth.tiles(), segment_view(camera, earth.ball()), 2);
        pass.upload(segments, layers);
        EXPECT_EQ(pass.sent_bytes(), 0u) << "at rest, frame " << frame;
    }
    EXPECT_LT(least, whole_mesh / 4);
    EXPECT_GE(pass.bytes(), whole_mesh);
}

// Segments that were not followed before are sent whole, also when they say that nothing has changed.
TEST_F(TerrainUpload, SendsOtherSegmentsWhole) {
    const ExaggeratedEarth earth(store_, 1);
    EarthViews views(width, height);
    planet::Segments one, other;
    TerrainPass pass;
    const Camera camera = views.next(earth).camera, elsewhere = views.next(earth).camera;
    one.update(earth.tiles(), segment_view(camera, earth.ball()), 2);
    other.update(earth.tiles(), segment_view(elsewhere, earth.ball()), 2);
    other.update(earth.tiles(), segment_view(elsewhere, earth.ball()), 2);
    ASSERT_TRUE(other.changed_vertices().empty());
    const std::vector<std::int32_t> layers(std::max(one.segments().size(), other.segments().size()), -1);
    pass.upload(one, layers);
    pass.upload(other, layers);
    EXPECT_GE(pass.sent_bytes(), other.vertex_count() * sizeof(planet::SegmentVertex));
}

}  // namespace
}  // namespace render
