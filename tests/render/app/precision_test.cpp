// Eyes that hardly move, from 1 m to 50,000 km: what is drawn moves as exact projection says, and nothing jitters. Steps
// are 1 mm at 2 m and in proportion elsewhere.

#include <gtest/gtest.h>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/surface_picture.h"
#include "tests/render/app/vertex_capture.h"

namespace render {
namespace {

using namespace testing;

constexpr double heights[] = {1, 2, 10, 100, 1e3, 10e3, 100e3, 1e6, 10e6, 50e6};  // m above the ground
constexpr int steps = 24;
constexpr double step_of_height = 0.5e-3;

/// By the definition of a pinhole camera, in double: pixels from the middle of the picture, y up.
glm::dvec2 exact_pixel(const Camera& camera, const glm::dvec3& from_eye) {
    const glm::dvec3 v = camera.view_from_ecef * from_eye;
    return glm::dvec2(v) * (camera.focal_px / -v.z);
}

/// A glide over the ground of the Sangre de Cristo.
class Glide {
  public:
    Glide(const ExaggeratedEarth& earth, double height, double pitch, int width, int picture_height)
        : normal_(planet::normal_from_geodetic(37.41 * degrees, -105.37 * degrees)),
          start_(planet::ecef_from_normal(wgs84, normal_, {earth.ground(normal_) + height})),
          ahead_(look_direction(normal_, 1.1, -0.2) * (step_of_height * height)),
          pitch_(pitch),
          width_(width),
          height_(picture_height) {}
    /// The eye is put on the grid, so steps are as long as that allows.
    Camera camera(int step) const {
        return make_camera(start_ + ahead_ * static_cast<double>(step), normal_, 0.7, pitch_,
                           focal_length_px(50 * degrees, width_, height_), width_, height_);
    }

  private:
    glm::dvec3 normal_, start_, ahead_;
    double pitch_;
    int width_, height_;
};

/// Looks at the ground below the horizon.
double pitch_at(double height) {
    return -std::acos(wgs84.b / (wgs84.b + height)) - 10 * degrees;
}

using Precision = DrawnEarth;

TEST_F(Precision, VerticesMoveAsExactProjectionSays) {
    constexpr int width = 1920, height = 1080;
    // So what moves by more than this moves the right way: monotonically.
    constexpr double off_px = 1.0 / 1024;
    const ExaggeratedEarth earth(store_, 1);
    VertexCapture capture;
    planet::Segments segments;
    double worst = 0, worst_step = 0;
    for (const double up : heights) {
        const Glide glide(earth, up, pitch_at(up), width, height);
        segments.build(earth.tiles(), segment_view(glide.camera(0), earth.ball(), 4), 2);
        std::vector<glm::dvec2> last, last_exact;
        std::size_t in_picture = 0;
        for (int step = 0; step < steps; ++step) {
            const Camera camera = glide.camera(step);
            const auto drawn = capture.decode(segments.vertices(), camera);
            std::vector<glm::dvec2> now(drawn.size()), now_exact(drawn.size());
            for (std::size_t i = 0; i < drawn.size(); ++i) {
                const glm::dvec3 place = planet::ecef_from_grid(segments.vertices()[i].position) - camera.eye;
                const glm::dvec4 clip(drawn[i].clip);
                now_exact[i] = exact_pixel(camera, place);
                now[i] = glm::dvec2(clip) / clip.w * glm::dvec2(0.5 * width, 0.5 * height);
                const bool in_front = (camera.view_from_ecef * place).z < -0.1;
                if (!in_front || std::fabs(now_exact[i].x) > 0.5 * width || std::fabs(now_exact[i].y) > 0.5 * height) {
                    now_exact[i].x = NAN;
                    continue;
                }
                ++in_picture;
                worst = std::max(worst, glm::distance(now[i], now_exact[i]));
                if (last.empty() || std::isnan(last_exact[i].x)) continue;
                const glm::dvec2 moved = now[i] - last[i], exactly = now_exact[i] - last_exact[i];
                worst_step = std::max(worst_step, glm::distance(moved, exactly));
            }
            last = std::move(now);
            last_exact = std::move(now_exact);
        }
        EXPECT_GT(in_picture, 100u * steps) << up << " m";
    }
    EXPECT_LE(worst, off_px);
    EXPECT_LE(worst_step, off_px);
}

// What a pixel shows lies in its middle, in every frame: rasterizing and interpolation included.
TEST_F(Precision, PixelsShowWhatLiesInTheirMiddle) {
    constexpr int width = 256, height = 192;
    constexpr double off_px = 1.0 / 64;
    const ExaggeratedEarth earth(store_, 1);
    SurfacePicture picture(width, height, GL_RGBA32F);
    planet::Segments segments;
    double worst = 0;
    for (const double up : heights) {
        const Glide glide(earth, up, pitch_at(up), width, height);
        segments.build(earth.tiles(), segment_view(glide.camera(0), earth.ball()), 2);
        const SegmentBuffers buffers(segments);
        for (int step = 0; step < steps; ++step) {
            const Camera camera = glide.camera(step);
            const auto positions = picture.positions(camera, [&] { buffers.draw_strips(segments.segments()); });
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const float* p = &positions[4 * static_cast<std::size_t>(y * width + x)];
                    if (p[3] == 0) continue;
                    const glm::dvec2 pixel = exact_pixel(camera, glm::dvec3(p[0], p[1], p[2]));
                    worst = std::max(worst, glm::distance(pixel, {x + 0.5 - 0.5 * width, 0.5 * height - y - 0.5}));
                }
        }
    }
    EXPECT_LE(worst, off_px);
}

}  // namespace
}  // namespace render
