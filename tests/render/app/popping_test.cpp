// Nothing pops: along a flight at half a pixel, the mesh of each frame and that of the next are drawn from one eye, and
// how far anything is from its place in the other picture is measured there. A surface point that moves up or down keeps
// its range (surface_picture.h); where it is now lies within r pixels of where it was if ranges on both sides of its own
// are found in a disc of radius r. That holds for silhouettes too, against the sky and against what is behind them.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"
#include "tests/render/app/surface_picture.h"

namespace render {
namespace {

using namespace testing;

constexpr int width = 160, height = 120;  // of one picture, pixels
constexpr int fine = 5;                   // the other has so many samples a pixel, each way
constexpr double farthest_px = 6;         // that is looked for

/// Samples of the fine picture by their distance from the middle of a pixel.
struct Disc {
    struct Sample {
        double distance_px;
        int x, y;
    };
    Disc() {
        constexpr int reach = static_cast<int>(farthest_px) * fine;
        for (int y = -reach; y <= reach; ++y)
            for (int x = -reach; x <= reach; ++x)
                if (std::hypot(x, y) <= reach) samples.push_back({std::hypot(x, y) / fine, x, y});
        std::sort(samples.begin(), samples.end(),
                  [](const Sample& a, const Sample& b) { return a.distance_px < b.distance_px; });
    }
    std::vector<Sample> samples;
};

/// The largest distance in pixels of anything in the picture from its place in the fine one, but for a rim of
/// farthest_px; infinity if it is beyond that.
double largest_move(const std::vector<float>& picture, const std::vector<float>& fine_picture) {
    static const Disc disc;
    constexpr int rim = static_cast<int>(farthest_px) + 1;
    double largest = 0;
    for (int y = rim; y < height - rim; ++y)
        for (int x = rim; x < width - rim; ++x) {
            const float range = picture[static_cast<std::size_t>(y * width + x)];
            float low = std::numeric_limits<float>::infinity(), high = 0;
            double move = std::numeric_limits<double>::infinity();
            for (const Disc::Sample& s : disc.samples) {
                const int column = x * fine + fine / 2 + s.x, row = y * fine + fine / 2 + s.y;
                const float there = fine_picture[static_cast<std::size_t>(row * width * fine + column)];
                low = std::min(low, there);
                high = std::max(high, there);
                if (low * (1 - 1e-5f) <= range && range <= high * (1 + 1e-5f)) {
                    move = s.distance_px;
                    break;
                }
            }
            largest = std::max(largest, move);
        }
    return largest;
}

/// A mesh as it was drawn in its frame, all around the planet.
struct FrameMesh {
    FrameMesh(const planet::Segments& s) : segments(s.segments().begin(), s.segments().end()), buffers(s) {}
    std::vector<planet::Segment> segments;
    SegmentBuffers buffers;
    void draw() const { buffers.draw_strips(segments); }
};

class Popping : public DrawnEarth {
  protected:
    void SetUp() override {
        DrawnEarth::SetUp();
        if (!context_) return;
        coarse_.emplace(width, height, GL_R32F);
        fine_.emplace(width * fine, height * fine, GL_R32F);
    }
    double move(const FrameMesh& from, const FrameMesh& to, const Camera& camera) {
        Camera sharp = camera;
        sharp.width *= fine;
        sharp.height *= fine;
        sharp.focal_px *= fine;
        const auto before = coarse_->ranges(camera, [&] { from.draw(); });
        const auto after = fine_->ranges(sharp, [&] { to.draw(); });
        return largest_move(before, after);
    }
    std::optional<SurfacePicture> coarse_, fine_;
};

/// Down from 20,000 km to 50 m above the Sangre de Cristo, turning, from looking down to looking ahead.
Camera flight_camera(const ExaggeratedEarth& earth, double part) {
    const double up = std::exp(std::lerp(std::log(20e6), std::log(50.0), part)), aside = std::sqrt(up / 20e6) * 30;
    const glm::dvec3 normal = planet::normal_from_geodetic((37.58 - aside) * degrees, (-105.49 - aside) * degrees);
    return make_camera(planet::ecef_from_normal(wgs84, normal, {earth.ground(normal) + up}), normal,
                       std::lerp(-60.0, 80.0, part) * degrees, std::lerp(-90.0, -4.0, part) * degrees,
                       focal_length_px(50 * degrees, width, height), width, height);
}

TEST_F(Popping, MovesNothingByMoreThanAPixel) {
    constexpr int frames = 300;
    const ExaggeratedEarth earth(store_, 1);
    planet::Segments segments;
    std::optional<FrameMesh> last;
    double largest = 0;
    int changed = 0;
    for (int frame = 0; frame <= frames; ++frame) {
        const Camera camera = flight_camera(earth, static_cast<double>(frame) / frames);
        segments.update(earth.tiles(), whole_planet_view(camera, earth.ball(), 0.5), 2);
        FrameMesh mesh(segments);
        if (last) {
            const double moved = frame % 2 == 0 ? move(*last, mesh, camera) : move(mesh, *last, camera);
            EXPECT_LE(moved, 1.0) << "frame " << frame;
            largest = std::max(largest, moved);
            changed += moved > 0;
        }
        last.emplace(std::move(mesh));
    }
    EXPECT_GT(changed, frames / 2) << "the meshes hardly differ: nothing was measured";
    RecordProperty("largest move in thousandths of a pixel", static_cast<int>(1000 * largest));
}

// A mesh that is off by several pixels is seen to move by more than one.
TEST_F(Popping, IsSeenWhereThereIsSome) {
    const ExaggeratedEarth earth(store_, 1);
    for (const double part : {0.7, 0.85, 0.95}) {
        const Camera camera = flight_camera(earth, part);
        const auto mesh = [&](double max_pixel_deviation) {
            planet::Segments segments;
            segments.build(earth.tiles(), whole_planet_view(camera, earth.ball(), max_pixel_deviation), 2);
            return FrameMesh(segments);
        };
        const FrameMesh fine_mesh = mesh(0.5), coarse_mesh = mesh(12);
        EXPECT_LE(move(fine_mesh, mesh(0.5), camera), 1.01 / fine) << "sampling alone";
        EXPECT_GT(move(fine_mesh, coarse_mesh, camera), 1) << "at " << part << " of the flight";
    }
}

}  // namespace
}  // namespace render
