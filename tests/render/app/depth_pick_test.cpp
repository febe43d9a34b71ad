// What a pixel shows, found twice: by a ray against the drawn triangles, and by the depth of the drawn pixel.

#include <gtest/gtest.h>

#include <cmath>

#include "render/viewer/ground_pick.h"
#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"
#include "tests/render/app/surface_picture.h"

namespace render {
namespace {

using namespace testing;

constexpr int width = 256, height = 192;

/// Distances along the view axis that rays through a pixel's middle and 1/64 pixel (precision_test.cpp) beside it meet.
struct Reach {
    double least = 1e30, most = 0;
    bool hit = false, missed = false;
};

Reach reach_of(GroundPick& pick, const Camera& camera, const glm::dvec2& pixel) {
    constexpr double off = 1.0 / 64;
    const glm::dvec3 ahead = -glm::transpose(camera.view_from_ecef)[2];
    Reach reach;
    for (const glm::dvec2 beside :
         {glm::dvec2(0), glm::dvec2(off), glm::dvec2(-off), glm::dvec2(off, -off), glm::dvec2(-off, off)}) {
        const glm::dvec3 at = ecef_from_screen(camera, {pixel + beside, 1});
        const auto hit = pick.first_hit(camera.eye, glm::normalize(at - camera.eye));
        reach.missed |= !hit;
        if (!hit) continue;
        reach.hit = true;
        const double along = glm::dot(*hit - camera.eye, ahead);
        reach.least = std::min(reach.least, along);
        reach.most = std::max(reach.most, along);
    }
    return reach;
}

using DepthPick = DrawnEarth;

// Over land and sea, at poles and seams, from 1 m to 50,000 km, at exaggeration 1 and 5.
TEST_F(DepthPick, AgreesWithTheRayToTheDepthsResolution) {
    std::size_t compared = 0, sky = 0;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth earth(store_, exaggeration);
        EarthViews views(width, height);
        SurfacePicture picture(width, height, GL_R32F);
        planet::Segments segments;
        GroundPick pick;
        for (int i = 0; i < 60; ++i) {
            const auto [camera, inside] = views.next(earth);
            if (inside) continue;
            segments.build(earth.tiles(), segment_view(camera, earth.ball()), 2);
            pick.follow(segments);
            const SegmentBuffers buffers(segments);
            const auto depths = picture.depths(camera, [&] { buffers.draw_strips(segments.segments()); });
            for (int y = 8; y < height; y += 58)
                for (int x = 5; x < width; x += 47) {
                    const double depth = static_cast<double>(depths[static_cast<std::size_t>(y * width + x)]);
                    const Reach reach = reach_of(pick, camera, {x + 0.5, y + 0.5});
                    if (depth == 0) {
                        EXPECT_TRUE(reach.missed) << "view " << i << ", pixel " << x << ' ' << y;
                        ++sky;
                        continue;
                    }
                    EXPECT_TRUE(reach.hit) << "view " << i << ", pixel " << x << ' ' << y;
                    if (reach.missed) continue;
                    ++compared;
                    const double along = camera.near_m / depth, resolution = depth_resolution(along);
                    EXPECT_GE(along, reach.least - resolution) << "view " << i << ", pixel " << x << ' ' << y;
                    EXPECT_LE(along, reach.most + resolution) << "view " << i << ", pixel " << x << ' ' << y;
                }
        }
    }
    EXPECT_GT(compared, 800u);
    EXPECT_GT(sky, 200u);
}

}  // namespace
}  // namespace render
