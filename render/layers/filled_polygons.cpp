#include "render/layers/filled_polygons.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planet/frames.h"
#include "planet/geodesy/geodesic.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/local_frame.h"
#include "render/layers/geodesic_lines.h"

namespace render {

namespace {

using planet::degrees;
using planet::wgs84;

// A wall of 50 km is 0.3 m off the geodesic in its middle. Rings of very long sides have longer ones, for memory's sake.
constexpr double wall_m = 50e3, longest_wall_m = 1000e3;
constexpr std::size_t most_walls = 1'000'000;
constexpr double least_side_px = 0.7, highest_ground_m = 9000;

void add_side(std::vector<glm::dvec3>& ring, const glm::dvec3& from, const glm::dvec3& to, double longest) {
    if (glm::distance(from, to) * wgs84.a > longest) {
        const glm::dvec3 middle = middle_of_side(from, to);
        add_side(ring, from, middle, longest);
        add_side(ring, middle, to, longest);
    } else {
        ring.push_back(to);
    }
}

/// How often a ring goes around a place, counter-clockwise, less how often around its antipode.
int turns_around(const glm::dvec3& normal, std::span<const glm::dvec3> ring) {
    const glm::dmat3 enu = planet::ecef_from_enu(normal);
    const auto azimuth = [&](const glm::dvec3& n) { return std::atan2(glm::dot(enu[1], n), glm::dot(enu[0], n)); };
    double turned = 0, last = azimuth(ring.back());
    for (const glm::dvec3& n : ring) {
        const double next = azimuth(n);
        turned += std::remainder(next - last, 2 * std::numbers::pi);
        last = next;
    }
    return static_cast<int>(std::lround(turned / (2 * std::numbers::pi)));
}

/// Of a ring, those that a view can tell apart.
std::vector<glm::dvec3> seen_apart(const std::vector<glm::dvec3>& ring, const Camera& camera) {
    std::vector<glm::dvec3> kept;
    glm::dvec3 last(1e30);
    for (const glm::dvec3& n : ring) {
        const glm::dvec3 foot = planet::ecef_from_normal(wgs84, n);
        const double distance = std::max(glm::distance(foot, camera.eye) - highest_ground_m, 1.0);
        if (glm::distance(foot, last) * camera.focal_px / distance < least_side_px) continue;
        kept.push_back(n);
        last = foot;
    }
    return kept;
}

}  // namespace

void FilledPolygons::add(const planet::Polygon& polygon) {
    add_ring(polygon.outer, false);
    for (const auto& hole : polygon.holes) add_ring(hole, true);
}

void FilledPolygons::add_ring(std::span<const glm::dvec3> closed, bool hole) {
    std::vector<planet::Geodetic> corners;
    for (const glm::dvec3& v : closed.first(closed.size() - 1))
        corners.push_back({v.y * degrees, std::remainder(v.x, 360.0) * degrees, {}});
    const planet::PolygonSize size = planet::Geodesics(wgs84).polygon(corners);
    if (size.area == 0) return;
    if ((size.area > 0) == hole) std::ranges::reverse(corners);
    const double longest = std::clamp(size.perimeter / static_cast<double>(most_walls), wall_m, longest_wall_m);
    std::vector<glm::dvec3>& ring = rings_.emplace_back();
    glm::dvec3 from = planet::normal_from_geodetic(corners.back().latitude, corners.back().longitude);
    for (const planet::Geodetic& corner : corners) {
        const glm::dvec3 to = planet::normal_from_geodetic(corner.latitude, corner.longitude);
        if (glm::distance(from, to) > 1e-12) add_side(ring, from, to, longest);
        from = to;
    }
    if (ring.size() < 3) rings_.pop_back();
}

PolygonWalls FilledPolygons::walls(const Camera& camera, double lowest_m) const {
    PolygonWalls walls;
    const glm::dvec3 eye_normal = planet::normal_from_ecef(wgs84, camera.eye);
    for (const auto& whole : rings_) {
        const std::vector<glm::dvec3> ring = seen_apart(whole, camera);
        if (ring.size() < 3) continue;
        walls.around_eye += turns_around(eye_normal, ring);
        const auto low = [&](const glm::dvec3& n) {
            return glm::vec4(glm::vec3(planet::ecef_from_normal(wgs84, n, {-lowest_m}) - camera.eye), 1);
        };
        const auto high = [](const glm::dvec3& n) { return glm::vec4(glm::vec3(n), 0); };
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec3 &from = ring[i], &to = ring[(i + 1) % ring.size()];
            walls.triangles.insert(walls.triangles.end(),
                                   {low(from), low(to), high(to), low(from), high(to), high(from)});
        }
    }
    return walls;
}

}  // namespace render
