#include "render/viewer/ground_pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace render {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Distance to a triangle that is counter-clockwise seen from the origin. Moeller and Trumbore (1997). A ray along a side
/// may round to neither of two triangles: the tolerance is a billionth of them.
double hit(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& a, const glm::dvec3& b,
           const glm::dvec3& c) {
    constexpr double tolerance = 1e-9;
    const glm::dvec3 ab = b - a, ac = c - a, p = glm::cross(direction, ac);
    const double determinant = glm::dot(ab, p);
    if (!(determinant > 0)) return never;
    const glm::dvec3 from = origin - a;
    const double u = glm::dot(from, p) / determinant;
    if (u < -tolerance || u > 1 + tolerance) return never;
    const glm::dvec3 q = glm::cross(from, ab);
    const double v = glm::dot(direction, q) / determinant;
    if (v < -tolerance || u + v > 1 + tolerance) return never;
    const double t = glm::dot(ac, q) / determinant;
    return t > 0 ? t : never;
}

}  // namespace

void GroundPick::measure() {
    spheres_.reserve(segments_->segments().size());
    for (const planet::Segment& s : segments_->segments()) {
        glm::dvec3 low(never), high(-never);
        for (const auto& v : segments_->vertices().subspan(s.first_vertex, s.vertex_count)) {
            const glm::dvec3 p = planet::ecef_from_grid(v.position);
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        spheres_.push_back({0.5 * (low + high), 0.5 * glm::length(high - low)});
    }
}

std::optional<glm::dvec3> GroundPick::first_hit(const glm::dvec3& origin, const glm::dvec3& direction) {
    if (segments_ == nullptr) return std::nullopt;
    if (spheres_.empty()) measure();
    double nearest = never;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const glm::dvec3 to = spheres_[i].centre - origin;
        const double along = glm::dot(to, direction), radius = spheres_[i].radius;
        if (along < -radius || along - radius > nearest || glm::dot(to, to) - along * along > radius * radius) continue;
        const planet::Segment& s = segments_->segments()[i];
        const std::uint32_t* index = segments_->indices().data() + s.first_index;
        const auto at = [&](std::uint32_t k) {
            return planet::ecef_from_grid(segments_->vertices()[s.first_vertex + index[k]].position);
        };
        for (std::uint32_t k = 0; k + 2 < s.index_count; ++k) {
            if (index[k] == index[k + 1] || index[k + 1] == index[k + 2] || index[k] == index[k + 2]) continue;
            const std::uint32_t odd = k & 1;
            nearest = std::min(nearest, hit(origin, direction, at(k + odd), at(k + 1 - odd), at(k + 2)));
        }
    }
    if (nearest == never) return std::nullopt;
    return origin + nearest * direction;
}

}  // namespace render
