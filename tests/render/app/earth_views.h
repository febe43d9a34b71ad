#pragma once
// The default Earth seen from anywhere: what the proofs about its pictures run over.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/mesh/segments.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/store_field.h"
#include "planet/streaming/store_tiles.h"
#include "render/app/picture/earth_store.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/picture/camera.h"

namespace render::testing {

using planet::degrees;
using planet::wgs84;

/// A store with its heights exaggerated.
class ExaggeratedEarth {
  public:
    ExaggeratedEarth(std::shared_ptr<const planet::ElevationStore> store, double exaggeration)
        : exaggeration_(exaggeration), field_(store), tiles_(field_.cache(), {wgs84, exaggeration}) {
        double lowest = 0;
        for (int face = 0; face < planet::face_count; ++face)
            lowest = std::min(
                lowest, static_cast<double>(field_.cache().tile(planet::LocationCode::face_root(face))->min_height));
        // The geoid goes down to -107 m, and the finest triangles run below the ground too.
        ball_ = wgs84.b + lowest * exaggeration - 400;
    }
    const planet::StoreField& field() const { return field_; }
    const planet::StoreTiles& tiles() const { return tiles_; }
    double exaggeration() const { return exaggeration_; }
    /// Radius of a ball below all terrain, m.
    double ball() const { return ball_; }
    /// The finest surface at a geodetic normal, m above the ellipsoid: where the normal meets the plane of its cell.
    double ground(const glm::dvec3& normal) const {
        planet::SurfaceCursor cursor = field_.cursor();
        cursor.seek(normal);
        const planet::LocationCode cell = cursor.cell();
        const planet::Tile& tile = cursor.tile();
        const int below = cell.bisection_level() - tile.root.bisection_level();
        const auto local =
            static_cast<std::size_t>((cell.bits() ^ tile.root.bits() << below) | std::uint64_t{1} << below);
        const planet::Corners c = planet::corners(cell);
        const glm::dvec3 normals[3] = {c.left, c.right, c.apex};
        glm::dvec3 at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = planet::tile_layout().corners[local][k];
            const planet::GeoidUndulation undulation =
                tile.undulation.empty() ? planet::GeoidUndulation{} : tile.undulation[v];
            at[k] = planet::Placement{wgs84, exaggeration_}.ecef(normals[k], static_cast<double>(tile.height[v]),
                                                                 undulation);
        }
        const glm::dvec3 plane = glm::cross(at[1] - at[0], at[2] - at[0]);
        return glm::dot(at[0] - planet::ecef_from_normal(wgs84, normal, {0}), plane) / glm::dot(normal, plane);
    }

  private:
    double exaggeration_;
    planet::StoreField field_;
    planet::StoreTiles tiles_;
    double ball_;
};

struct EarthView {
    Camera camera;
    bool inside;  ///< the planet
};

/// Random views, the same on every machine: near the finest data, from inside the planet, and anywhere, seams first.
class EarthViews {
  public:
    /// @param widest_fov degrees, across the shorter side
    EarthViews(int width, int height, std::uint64_t seed = 3, double widest_fov = 100)
        : width_(width), height_(height), widest_fov_(widest_fov), engine_(seed) {}

    EarthView next(const ExaggeratedEarth& earth) {
        constexpr double seams[][2] = {{90, 0},  {-90, 0},  {0, 0},   {0, 90},  {0, 180},
                                       {0, -90}, {30, 180}, {45, 90}, {-60, 0}, {89.99, 45}};
        const std::size_t i = count_++;
        double latitude = std::asin(between(-1, 1)) / degrees, longitude = between(-180, 180);
        if (i % 4 == 0) latitude = between(37.1, 37.95), longitude = between(-105.9, -104.1);
        if (i % 4 != 0 && i / 2 < std::size(seams)) latitude = seams[i / 2][0], longitude = seams[i / 2][1];
        const glm::dvec3 normal = planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
        const bool inside = i % 4 == 3;
        // Above the ground 1 m to 131 km over the finest data, 1 m to 50,000 km elsewhere.
        const double h = inside ? -std::exp2(between(15, 22))
                                : earth.ground(normal) + std::exp2(between(0, i % 4 == 0 ? 17 : 25.575));
        const double dip = inside ? 0 : std::acos(wgs84.b / (wgs84.b + std::max(h, 0.0))) / degrees;
        const double pitch = inside ? between(-90, 90) : -between(dip - 5, std::min(90.0, dip + 40));
        const double fov = between(20, widest_fov_), heading = between(0, 360);
        return {make_camera(planet::ecef_from_normal(wgs84, normal, {h}), normal, heading * degrees, pitch * degrees,
                            focal_length_px(fov * degrees, width_, height_), width_, height_),
                inside};
    }

    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
    }

  private:
    int width_, height_;
    double widest_fov_;
    std::mt19937_64 engine_;
    std::size_t count_ = 0;
};

inline PicturePart whole(const Camera& camera) {
    return {0, 0, camera.width, camera.height};
}

/// The view that a picture of this camera is built for. @param ball see ExaggeratedEarth::ball()
inline planet::SegmentView segment_view(const Camera& camera, double ball, double max_pixel_deviation = 1) {
    planet::SegmentView view;
    view.test = {camera.eye, planet::split_reach(camera.focal_px, camera.tan_corner(), max_pixel_deviation)};
    view.culling = camera.culling(whole(camera), ball);
    view.radius_m = wgs84.mean_radius();
    view.segment_angle = 96 / camera.focal_px;
    return view;
}

/// The same with nothing culled: the whole planet, closed.
inline planet::SegmentView whole_planet_view(const Camera& camera, double ball, double max_pixel_deviation = 1) {
    planet::SegmentView view = segment_view(camera, ball, max_pixel_deviation);
    view.culling = {};
    view.culling.eye = camera.eye;
    return view;
}

/// A test with OpenGL.
class Drawn : public ::testing::Test {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create());
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
        set_reversed_depth();
    }
    std::optional<Context> context_;
};

/// A test that draws the default Earth.
class DrawnEarth : public Drawn {
  protected:
    void SetUp() override {
        Drawn::SetUp();
        if (!context_) return;
        const EarthSources sources;
        LazyEarth earth(sources);
        ChecksumIndex index = user_checksum_index();
        store_ = open_earth_store(sources, earth, index, [](std::string_view, double) {});
    }
    std::shared_ptr<const planet::ElevationStore> store_;
};

}  // namespace render::testing
