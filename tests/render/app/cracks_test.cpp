// No cracks, seen: the default Earth's segments, through the vertex shader pictures are drawn with, in white on magenta.
//
// What is tested, in every view and pixel for pixel:
//   ball      a pixel whose ray meets a ball that lies below all that is drawn is not magenta. Exact, and what counts
//             for eyes inside the planet, where it holds for every pixel
//   regions   every magenta region reaches the picture's border. Terrain is a height field, so sky that is enclosed by
//             terrain is a hole (an eye above it, nothing overhangs). This covers the belt between ball and terrain;
//             a crack that opens into the sky is not seen by it, but by crossings_test.cpp
// A crack narrower than a pixel shows in some pixels of some views: the views are many.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"

namespace render {
namespace {

using namespace testing;

constexpr int side = 256;  // of the pictures, pixels

std::optional<std::string_view> white_or_real(std::string_view name) {
    if (name == "white.frag.glsl") return "#version 450 core\nout vec4 color;\nvoid main() { color = vec4(1.0); }\n";
    return find_shader_source(name);
}

class WhitePass {
  public:
    void begin(const Camera& camera, bool cull_faces) {
        target_.bind();
        target_.clear(1, 0, 1, 1);
        program_.use();
        set_grid_camera(program_, camera, {0, 0, side, side});
        gl().Enable(GL_DEPTH_TEST);
        gl().DepthFunc(GL_GREATER);
        (cull_faces ? gl().Enable : gl().Disable)(GL_CULL_FACE);
    }
    /// Magenta or not, by pixel, the top row first.
    std::vector<bool> magenta() const {
        const auto rgba = target_.read_rgba8();
        std::vector<bool> result(side * side);
        for (std::size_t i = 0; i < result.size(); ++i) result[i] = rgba[4 * i + 1] == 0;
        return result;
    }
    std::vector<bool> magenta(const planet::Segments& segments, const Camera& camera, bool cull_faces) {
        begin(camera, cull_faces);
        SegmentBuffers(segments).draw_strips(segments.segments());
        return magenta();
    }

  private:
    Program program_ = Program::link({"terrain.vert.glsl", "white.frag.glsl"}, {.find = white_or_real});
    Framebuffer target_{side, side};
};

std::size_t index_of(int x, int y) {
    return static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x);
}

/// Pixels whose ray meets the ball although they are magenta.
std::size_t holes_in_ball(const std::vector<bool>& magenta, const Camera& camera, double ball) {
    std::size_t holes = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::dvec3 view(x + 0.5 - 0.5 * side, 0.5 * side - y - 0.5, -camera.focal_px);
            const glm::dvec3 ray = glm::normalize(glm::transpose(camera.view_from_ecef) * view);
            const double along = -glm::dot(camera.eye, ray), eye2 = glm::dot(camera.eye, camera.eye);
            const bool meets = eye2 < ball * ball || (along > 0 && eye2 - along * along < ball * ball);
            holes += meets && magenta[index_of(x, y)];
        }
    return holes;
}

/// Magenta pixels that no path of magenta pixels, side by side or corner to corner, joins to the border.
std::size_t enclosed(std::vector<bool> magenta) {
    std::vector<std::pair<int, int>> open;
    const auto take = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= side || y >= side || !magenta[index_of(x, y)]) return;
        magenta[index_of(x, y)] = false;
        open.emplace_back(x, y);
    };
    for (int i = 0; i < side; ++i) take(i, 0), take(i, side - 1), take(0, i), take(side - 1, i);
    while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) take(x + dx, y + dy);
    }
    return static_cast<std::size_t>(std::count(magenta.begin(), magenta.end(), true));
}

using Cracks = DrawnEarth;

TEST_F(Cracks, NoneInAnyView) {
    constexpr std::size_t count = 152;  // for each exaggeration
    WhitePass pass;
    planet::Segments segments;
    std::size_t sky = 0, ground = 0;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth terrain(store_, exaggeration);
        EarthViews views(side, side);
        for (std::size_t i = 0; i < count; ++i) {
            const EarthView view = views.next(terrain);
            segments.build(terrain.tiles(), segment_view(view.camera, terrain.ball()), 2);
            const auto magenta = pass.magenta(segments, view.camera, !view.inside);
            // Where triangles are coarse they run below the surface they stand for.
            const double ball = terrain.ball() - segments.deviation_max_m();
            EXPECT_EQ(holes_in_ball(magenta, view.camera, ball), 0u)
                << "view " << i << ", exaggeration " << exaggeration;
            EXPECT_EQ(enclosed(magenta), 0u) << "view " << i << ", exaggeration " << exaggeration;
            const auto empty = static_cast<std::size_t>(std::count(magenta.begin(), magenta.end(), true));
            if (view.inside) {
                EXPECT_EQ(empty, 0u) << "view " << i;
            }
            (empty > 0 && empty < magenta.size() ? sky : ground) += 1;
        }
    }
    EXPECT_GE(sky, 60u);  // views with a silhouette
    EXPECT_GE(ground, 60u);
}

// The measures see cracks: meshes of two accuracies side by side do not meet, and a segment left out is a hole.
TEST_F(Cracks, AreSeenWhereThereAreSome) {
    const ExaggeratedEarth terrain(store_, 5);
    const glm::dvec3 normal = planet::normal_from_geodetic(37.5 * degrees, -105.4 * degrees);
    const Camera camera = make_camera(planet::ecef_from_normal(wgs84, normal, {80e3}), normal, 0, -90 * degrees,
                                      focal_length_px(40 * degrees, side, side), side, side);
    planet::SegmentView view = segment_view(camera, terrain.ball());
    planet::Segments fine, coarse;
    fine.build(terrain.tiles(), view, 1);
    view.test.K /= 20;
    coarse.build(terrain.tiles(), view, 1);
    const auto in_coarse = [&](const planet::Segment& s) {
        return std::any_of(coarse.segments().begin(), coarse.segments().end(),
                           [&](const planet::Segment& c) { return c.root == s.root; });
    };
    WhitePass pass;
    ASSERT_EQ(enclosed(pass.magenta(fine, camera, true)), 0u);
    ASSERT_EQ(enclosed(pass.magenta(coarse, camera, true)), 0u);

    // Every other segment that both have is drawn coarse.
    const auto swapped = [&](const planet::Segment& s) { return s.root.bits() % 2 == 0 && in_coarse(s); };
    pass.begin(camera, true);
    SegmentBuffers(fine).draw_strips(fine.segments(), [&](const planet::Segment& s) { return !swapped(s); });
    SegmentBuffers(coarse).draw_strips(coarse.segments(), [&](const planet::Segment& s) {
        return swapped(s) && std::any_of(fine.segments().begin(), fine.segments().end(),
                                         [&](const planet::Segment& f) { return f.root == s.root; });
    });
    EXPECT_GT(enclosed(pass.magenta()), 0u);

    // Every tenth segment is left out.
    std::size_t count = 0;
    pass.begin(camera, true);
    SegmentBuffers(fine).draw_strips(fine.segments(), [&](const planet::Segment&) { return ++count % 10 != 0; });
    EXPECT_GT(holes_in_ball(pass.magenta(), camera, terrain.ball()), 0u);
}

}  // namespace
}  // namespace render
