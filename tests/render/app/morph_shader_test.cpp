// Vertices that morph, as the vertex shader moves them: by the weight of planet/mesh/morph.h, to the same bits in all
// segments, and without a crack, whatever K they morph by.

#include <gtest/gtest.h>

#include "planet/mesh/morph.h"
#include "tests/render/app/crossing_count.h"
#include "tests/render/app/earth_views.h"
#include "tests/render/app/seams.h"
#include "tests/render/app/vertex_capture.h"

namespace render {
namespace {

using namespace testing;

constexpr int width = 256, height = 192;
constexpr double share_of_reach[] = {1, 0.5, 2};  // of the K that the mesh is built with

planet::SegmentView morph_view(const Camera& camera, const ExaggeratedEarth& earth) {
    planet::SegmentView view = whole_planet_view(camera, earth.ball(), 2);
    view.morph = true;
    return view;
}

using MorphShader = DrawnEarth;

TEST_F(MorphShader, MovesVerticesByTheirOwnWeight) {
    const ExaggeratedEarth earth(store_, 1);
    EarthViews views(width, height, 13);
    VertexCapture still, morphing({"MORPH"});
    planet::Segments segments;
    std::size_t between = 0;
    for (int i = 0; i < 24; ++i) {
        const Camera camera = views.next(earth).camera;
        const planet::SegmentView view = morph_view(camera, earth);
        segments.build(earth.tiles(), view, 2);
        const SegmentBuffers buffers(segments);
        const std::size_t count = segments.vertices().size();
        morphing.set_morph_reach(view.test.K);
        const auto places = still.decode(buffers, count, camera), moved = morphing.decode(buffers, count, camera);
        for (std::size_t v = 0; v < count; ++v) {
            const planet::MorphVertex& m = segments.morphs()[v];
            const glm::dvec3 place(places[v].view), offset(m.x, m.y, m.z);
            const double reach = static_cast<double>(m.radius) + view.test.K * static_cast<double>(m.deviation);
            const double f = planet::arrival_fraction(glm::length(place), reach, static_cast<double>(m.width));
            const double off = glm::distance(glm::dvec3(moved[v].view), place + (1 - f) * offset);
            // Of a difference of floats, over the width.
            const double rounding =
                std::min(1.0, 4e-7 * (reach + glm::length(place)) / std::max(static_cast<double>(m.width), 1e-6));
            ASSERT_LE(off, 4e-7 * glm::length(place) + (1e-4 + rounding) * glm::length(offset))
                << "view " << i << ", vertex " << v;
            between += f > 0.01 && f < 0.99;
        }
    }
    EXPECT_GT(between, 500u);  // a vertex moves over a small part of its reach
}

TEST_F(MorphShader, KeepsSeamsClosed) {
    VertexCapture capture({"MORPH"});
    CrossingCount crossings(width, height, {"MORPH"});
    planet::Segments segments;
    std::size_t border = 0;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth earth(store_, exaggeration);
        EarthViews views(width, height, 17);
        for (int i = 0; i < 12; ++i) {
            const Camera camera = views.next(earth).camera;
            const planet::SegmentView view = morph_view(camera, earth);
            segments.build(earth.tiles(), view, 2);
            const SegmentBuffers buffers(segments);
            const auto triangles = triangles_of(segments);
            for (const double share : share_of_reach) {
                capture.set_morph_reach(share * view.test.K);
                crossings.set_morph_reach(share * view.test.K);
                const auto decoded = capture.decode<DecodedVertex>(buffers, segments.vertices().size(), camera);
                const Seams seams = seams_of(triangles, decoded);
                EXPECT_EQ(seams.open, 0u) << "view " << i << ", share " << share;
                border += seams.border;
                // The ground near the eye may have risen above it or sunk: all rays begin outside, or all inside.
                const auto sums = crossings.count(camera, [&] { buffers.draw_strips(segments.segments()); });
                EXPECT_TRUE(sums[0] == 0 || sums[0] == -1);
                EXPECT_EQ(std::count(sums.begin(), sums.end(), sums[0]), width * height)
                    << "view " << i << ", share " << share;
            }
        }
    }
    EXPECT_GT(border, 100000u);
}

}  // namespace
}  // namespace render
