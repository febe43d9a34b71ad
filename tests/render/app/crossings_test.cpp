// No cracks, into the sky neither: what rays cross (crossing_count.h), over the whole planet in segments.
//
// Pixels of a picture sample few rays, and a crack may be narrower than their distance. So the same meshes are looked at
// again through a telescope, at vertices that segments share, with a pixel as small as the roundings of the vertex shader:
// there a vertex that is off by the least step there is opens a crack several pixels wide.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

#include "tests/render/app/crossing_count.h"
#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"

namespace render {
namespace {

using namespace testing;

constexpr int width = 256, height = 192;
constexpr double telescope_px = 0x1p22;  // focal length: 0.24 microradians a pixel
// Clipping rounds to 24 bits of what it cuts: a triangle this much larger than a pixel is cut within 1/16 of a pixel.
constexpr double largest_cut_px = 0x1p20;

std::size_t wrong(const std::vector<int>& sums, int expected) {
    return static_cast<std::size_t>(std::count_if(sums.begin(), sums.end(), [&](int sum) { return sum != expected; }));
}

/// From the same place, with the point in the middle of the picture.
Camera aimed(Camera camera, const glm::dvec3& point, double focal_px) {
    const glm::dvec3 back = glm::normalize(camera.eye - point);
    const glm::dvec3 beside = std::fabs(back.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(beside, back));
    camera.view_from_ecef = glm::transpose(glm::dmat3(right, glm::cross(back, right), back));
    camera.focal_px = focal_px;
    return camera;
}

/// The triangles that are not wholly beyond one side of the picture, and the largest angle that one of them fills, rad
/// (infinite around the eye).
struct InSight {
    std::vector<std::uint32_t> indices;
    double largest = 0;
};

InSight in_sight(const planet::Segments& segments, const std::vector<SegmentTriangle>& triangles,
                 const Camera& camera) {
    const planet::Culling culling = camera.culling(whole(camera), 0);
    InSight seen;
    for (const SegmentTriangle& t : triangles) {
        glm::dvec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = planet::ecef_from_grid(segments.vertices()[t.vertex[k]].position) - camera.eye;
        const bool beyond = std::any_of(culling.inward.begin(), culling.inward.end(), [&](const glm::dvec3& n) {
            return glm::dot(n, p[0]) < 0 && glm::dot(n, p[1]) < 0 && glm::dot(n, p[2]) < 0;
        });
        if (beyond) continue;
        seen.indices.insert(seen.indices.end(), t.vertex.begin(), t.vertex.end());
        const double side = std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
        const double nearest = std::min({glm::length(p[0]), glm::length(p[1]), glm::length(p[2])}) - side;
        seen.largest = std::max(seen.largest, nearest > 0 ? side / nearest : std::numeric_limits<double>::infinity());
    }
    return seen;
}

/// A vertex of Segments::vertices() at each position that lies in two segments or more.
std::vector<std::uint32_t> border_vertices(const planet::Segments& segments,
                                           const std::vector<SegmentTriangle>& triangles) {
    struct Found {
        std::uint32_t vertex, segment;
        bool shared;
    };
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>, Found> found;
    for (const SegmentTriangle& t : triangles)
        for (const std::uint32_t v : t.vertex) {
            const planet::GridPosition& p = segments.vertices()[v].position;
            const auto [at, is_new] = found.try_emplace({p.x, p.y, p.z, p.low}, Found{v, t.segment, false});
            if (at->second.segment != t.segment) at->second.shared = true;
        }
    std::vector<std::uint32_t> list;
    for (const auto& [position, f] : found)
        if (f.shared) list.push_back(f.vertex);
    return list;
}

/// The number of a triangle that the ray from the eye meets first.
std::size_t first_met(const planet::Segments& segments, const std::vector<SegmentTriangle>& triangles,
                      const glm::dvec3& eye, const glm::dvec3& ray) {
    std::size_t first = triangles.size();
    double nearest = 1e30;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        glm::dvec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = planet::ecef_from_grid(segments.vertices()[triangles[i].vertex[k]].position) - eye;
        const double a = glm::dot(ray, glm::cross(p[1], p[2])), b = glm::dot(ray, glm::cross(p[2], p[0])),
                     c = glm::dot(ray, glm::cross(p[0], p[1]));
        if (!((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) || a + b + c == 0) continue;
        const double along = glm::dot(ray, (a * p[0] + b * p[1] + c * p[2]) / (a + b + c));
        if (along > 0 && along < nearest) nearest = along, first = i;
    }
    return first;
}

using Crossings = DrawnEarth;

TEST_F(Crossings, CancelInEveryView) {
    constexpr std::size_t count = 152;  // for each exaggeration
    CrossingCount crossings(width, height);
    planet::Segments segments;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth earth(store_, exaggeration);
        EarthViews views(width, height);
        for (std::size_t i = 0; i < count; ++i) {
            const EarthView view = views.next(earth);
            segments.build(earth.tiles(), whole_planet_view(view.camera, earth.ball()), 2);
            const SegmentBuffers buffers(segments);
            const auto sums = crossings.count(view.camera, [&] { buffers.draw_strips(segments.segments()); });
            EXPECT_EQ(wrong(sums, view.inside ? -1 : 0), 0u) << "view " << i << ", exaggeration " << exaggeration;
        }
    }
}

// Low over crests, which run along the line of sight, all around.
TEST_F(Crossings, CancelLowOverHills) {
    constexpr double hills[][2] = {{37.2, -105.2}, {37.58, -105.49}, {37.97, -105.55}, {37.35, -104.99}};
    CrossingCount crossings(width, height);
    planet::Segments segments;
    const ExaggeratedEarth earth(store_, 1);
    for (const auto& [latitude, longitude] : hills) {
        const glm::dvec3 normal = planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
        const glm::dvec3 eye = planet::ecef_from_normal(wgs84, normal, {earth.ground(normal) + 50});
        for (int heading = 0; heading < 360; heading += 45) {
            const Camera camera = make_camera(eye, normal, heading * degrees, 0,
                                              focal_length_px(40 * degrees, width, height), width, height);
            segments.build(earth.tiles(), whole_planet_view(camera, earth.ball(), 0.5), 2);
            const SegmentBuffers buffers(segments);
            const auto sums = crossings.count(camera, [&] { buffers.draw_strips(segments.segments()); });
            EXPECT_EQ(wrong(sums, 0), 0u) << "hill at " << latitude << "," << longitude << ", heading " << heading;
        }
    }
}

TEST_F(Crossings, CancelAtBorderVerticesThroughATelescope) {
    constexpr std::size_t count = 16, vertices = 8;
    std::size_t sharpest = 0;
    CrossingCount crossings(width, height);
    planet::Segments segments;
    for (const double exaggeration : {1.0, 5.0}) {
        const ExaggeratedEarth earth(store_, exaggeration);
        EarthViews views(width, height, 5);
        for (std::size_t i = 0; i < count; ++i) {
            const EarthView view = views.next(earth);
            segments.build(earth.tiles(), whole_planet_view(view.camera, earth.ball()), 2);
            const auto triangles = triangles_of(segments);
            const auto border = border_vertices(segments, triangles);
            ASSERT_GE(border.size(), vertices);
            for (std::size_t k = 0; k < vertices; ++k) {
                const auto pick = static_cast<std::size_t>(views.between(0, static_cast<double>(border.size())));
                const glm::dvec3 point = planet::ecef_from_grid(segments.vertices()[border[pick]].position);
                Camera camera = aimed(view.camera, point, telescope_px);
                InSight seen = in_sight(segments, triangles, camera);
                for (; seen.largest * camera.focal_px > largest_cut_px && camera.focal_px > view.camera.focal_px;
                     seen = in_sight(segments, triangles, camera))
                    camera.focal_px /= 16;
                sharpest += camera.focal_px == telescope_px;
                const SegmentBuffers buffers(segments.vertices(), seen.indices);
                const auto sums = crossings.count(camera, [&] { buffers.draw_list(seen.indices.size()); });
                EXPECT_EQ(wrong(sums, view.inside ? -1 : 0), 0u)
                    << "view " << i << ", vertex " << border[pick] << ", exaggeration " << exaggeration;
            }
        }
    }
    EXPECT_GE(sharpest, count * vertices / 2);  // of 2 count * vertices
}

// A triangle that is missing shows, whether it lies far away, under the eye and on both sides of the near plane, or is
// seen from inside.
TEST_F(Crossings, ShowATriangleThatIsMissing) {
    struct Place {
        double height, pitch;
    };
    constexpr Place places[] = {{100e3, -90}, {3000, -20}, {1, -10}, {1, -89}, {-40e3, 70}};
    const ExaggeratedEarth earth(store_, 1);
    const glm::dvec3 normal = planet::normal_from_geodetic(37.6 * degrees, -105.4 * degrees);
    CrossingCount crossings(width, height);
    planet::Segments segments;
    for (const Place& place : places) {
        const glm::dvec3 eye = planet::ecef_from_normal(wgs84, normal, {earth.ground(normal) + place.height});
        const Camera camera = make_camera(eye, normal, 0, place.pitch * degrees,
                                          focal_length_px(60 * degrees, width, height), width, height);
        segments.build(earth.tiles(), whole_planet_view(camera, earth.ball()), 2);
        auto triangles = triangles_of(segments);
        const int expected = place.height < 0 ? -1 : 0;
        const auto count = [&] {
            std::vector<std::uint32_t> indices;
            for (const SegmentTriangle& t : triangles) indices.insert(indices.end(), t.vertex.begin(), t.vertex.end());
            const SegmentBuffers buffers(segments.vertices(), indices);
            return wrong(crossings.count(camera, [&] { buffers.draw_list(indices.size()); }), expected);
        };
        EXPECT_EQ(count(), 0u) << place.height << " m";
        const std::size_t first = first_met(segments, triangles, camera.eye, -glm::transpose(camera.view_from_ecef)[2]);
        ASSERT_LT(first, triangles.size());
        triangles.erase(triangles.begin() + static_cast<std::ptrdiff_t>(first));
        EXPECT_GT(count(), 0u) << place.height << " m";
    }
}

// A vertex that is off by one step of the grid, 3.8 micrometres, in one of its segments shows through the telescope.
TEST_F(Crossings, ShowAVertexOffByOneStepOfTheGrid) {
    const ExaggeratedEarth earth(store_, 1);
    CrossingCount crossings(width, height);
    planet::Segments segments;
    const auto build = [&](const glm::dvec3& eye, const glm::dvec3& normal) {
        const Camera camera =
            make_camera(eye, normal, 0, 0, focal_length_px(60 * degrees, width, height), width, height);
        segments.build(earth.tiles(), whole_planet_view(camera, earth.ball()), 2);
        return camera;
    };
    const glm::dvec3 near_it = planet::normal_from_geodetic(37.6 * degrees, -105.4 * degrees);
    const glm::dvec3 hover = planet::ecef_from_normal(wgs84, near_it, {earth.ground(near_it) + 100});
    build(hover, near_it);
    std::uint32_t nearest = 0;
    double least = 1e30;
    for (const std::uint32_t v : border_vertices(segments, triangles_of(segments))) {
        const double d = glm::distance(planet::ecef_from_grid(segments.vertices()[v].position), hover);
        if (d < least) least = d, nearest = v;
    }
    const glm::dvec3 point = planet::ecef_from_grid(segments.vertices()[nearest].position);
    const planet::NormalPosition ground = planet::position_from_ecef(wgs84, point);
    for (const double distance : {2.0, 8.0}) {
        const Camera eye =
            build(planet::ecef_from_normal(wgs84, ground.normal, {ground.h.m + distance}), ground.normal);
        const Camera camera = aimed(eye, point, telescope_px);
        std::vector<planet::SegmentVertex> vertices(segments.vertices().begin(), segments.vertices().end());
        const auto count = [&] {
            const SegmentBuffers buffers(vertices, segments.indices());
            return wrong(crossings.count(camera, [&] { buffers.draw_strips(segments.segments()); }), 0);
        };
        EXPECT_EQ(count(), 0u);
        const planet::GridPosition position = planet::grid_from_ecef(point);
        const auto found =
            std::find_if(vertices.begin(), vertices.end(), [&](const auto& v) { return v.position == position; });
        ASSERT_NE(found, vertices.end()) << "the vertex is gone from the mesh seen from " << distance << " m";
        found->position.low ^= 1;
        EXPECT_GT(count(), 0u) << distance << " m";
    }
}

}  // namespace
}  // namespace render
