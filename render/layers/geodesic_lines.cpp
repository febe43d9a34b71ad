#include "render/layers/geodesic_lines.h"

#include <algorithm>
#include <cmath>

#include "planet/frames.h"
#include "planet/geodesy/geodesic.h"

namespace render {

namespace {

using planet::degrees;
using planet::wgs84;

constexpr std::size_t run_vertices = 64;
constexpr double great_circle_up_to = 20e3;  // m: a geodesic is 0.05 m from it there

GeodesicLines::Run run_of(std::span<const glm::dvec3> normals, std::size_t first, bool begins) {
    GeodesicLines::Run run{
        static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(normals.size()), begins, {}, 0};
    glm::dvec3 low(1e30), high(-1e30);
    double longest = 0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const glm::dvec3 p = planet::ecef_from_normal(wgs84, normals[i]);
        low = glm::min(low, p);
        high = glm::max(high, p);
        if (i > 0) longest = std::max(longest, glm::distance(normals[i], normals[i - 1]));
    }
    run.centre = 0.5 * (low + high);
    // A side bulges from its chord by an eighth of its square, and by its radius at most.
    const double chord = longest * wgs84.a;
    run.radius = 0.5 * glm::length(high - low) + std::min(chord * chord / (4 * wgs84.b), 2 * wgs84.a);
    return run;
}

}  // namespace

void GeodesicLines::add(std::span<const glm::dvec3> longitude_latitude) {
    const std::size_t start = normals_.size();
    for (const glm::dvec3& v : longitude_latitude) {
        const glm::dvec3 n = planet::normal_from_geodetic(v.y * degrees, std::remainder(v.x, 360.0) * degrees);
        if (normals_.size() == start || glm::distance(normals_.back(), n) > 1e-12) normals_.push_back(n);
    }
    const std::size_t end = normals_.size();
    if (start == end) return;
    std::size_t first = start;
    do {
        const std::size_t last = std::min(first + run_vertices, end - 1);
        runs_.push_back(run_of(std::span(normals_).subspan(first, last - first + 1), first, first == start));
        first = last;
    } while (first + 1 < end);
}

std::span<const glm::dvec3> GeodesicLines::line(std::size_t first_run) const {
    std::size_t last = first_run;
    while (last + 1 < runs_.size() && !runs_[last + 1].begins) ++last;
    const std::size_t from = runs_[first_run].first;
    return std::span(normals_).subspan(from, runs_[last].first + runs_[last].count - from);
}

glm::dvec3 middle_of_side(const glm::dvec3& from, const glm::dvec3& to) {
    if (glm::distance(from, to) * wgs84.a < great_circle_up_to) return glm::normalize(from + to);
    static const planet::Geodesics geodesics(wgs84);
    const planet::Geodetic a = planet::geodetic_from_normal(from), b = planet::geodetic_from_normal(to);
    const planet::GeodesicInverse line = geodesics.inverse(a, b);
    const planet::GeodesicPoint middle = geodesics.direct(a, line.start_azimuth, 0.5 * line.distance);
    return planet::normal_from_geodetic(middle.latitude, middle.longitude);
}

}  // namespace render
