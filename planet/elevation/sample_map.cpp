#include "planet/elevation/sample_map.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "planet/frames.h"
#include "planet/geodesy/angles.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t piece = 256;  // points at a time: their arrays stay in the first-level cache

struct CubePoint {
    std::size_t face;
    glm::dvec2 uv;  // [-1, 1]
};

glm::dvec2 face_coordinates(const glm::dvec3& n, std::size_t face) {
    const int axis = static_cast<int>(face / 2);
    return glm::dvec2(n[(axis + 1) % 3], n[(axis + 2) % 3]) / std::abs(n[axis]);
}

CubePoint cube_from_normal(const glm::dvec3& n) {
    const glm::dvec3 a = glm::abs(n);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const std::size_t face = static_cast<std::size_t>(2 * axis + (n[axis] < 0 ? 1 : 0));
    return {face, face_coordinates(n, face)};
}

glm::dvec3 normal_from_cube(std::size_t face, glm::dvec2 uv) {
    const int axis = static_cast<int>(face / 2);
    glm::dvec3 n;
    n[axis] = face % 2 != 0 ? -1 : 1;
    n[(axis + 1) % 3] = uv.x;
    n[(axis + 2) % 3] = uv.y;
    return glm::normalize(n);
}

glm::dvec3 normal_from_degrees(glm::dvec2 longitude_latitude) {
    const double latitude = std::clamp(longitude_latitude.y, -90.0, 90.0);
    return normal_from_geodetic(latitude * degrees, longitude_latitude.x * degrees);
}

}  // namespace

SampleMap::SampleMap(const RasterHeader& raster)
    : size_(raster.width, raster.height), grid_(raster.grid), transform_(raster.transform) {
    assert(!raster.plain);
    middle_ = 0.5 * (size_ - 1.0);
    crs_middle_ = grid_.crs_from_sample(middle_);
    const double d = grid_.determinant();
    by_x_ = glm::dvec2(grid_.per_row.y, -grid_.per_column.y) / d;
    by_y_ = glm::dvec2(-grid_.per_row.x, grid_.per_column.x) / d;
    if (transform_) build_patches();
    if (transform_ || grid_.per_column.y != 0 || grid_.per_row.x != 0) return;
    for (int column = 0; column < raster.width; ++column) {
        const double longitude = grid_.crs_from_sample({column, 0}).x * degrees;
        meridians_.emplace_back(std::cos(longitude), std::sin(longitude));
    }
    for (int row = 0; row < raster.height; ++row) {
        const double latitude = std::clamp(grid_.crs_from_sample({0, row}).y, -90.0, 90.0) * degrees;
        parallels_.emplace_back(std::cos(latitude), std::sin(latitude));
    }
}

void SampleMap::samples_from_normals(std::span<const glm::dvec3> normals, std::span<glm::dvec2> samples) const {
    assert(samples.size() == normals.size());
    if (!transform_) return from_longitude_latitude(normals, samples);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const CubePoint c = cube_from_normal(normals[i]);
        const auto& map = from_cube_[c.face];
        samples[i] = map ? glm::dvec2((*map)(c.uv)) : glm::dvec2(nan);
    }
}

void SampleMap::from_longitude_latitude(std::span<const glm::dvec3> normals, std::span<glm::dvec2> samples) const {
    double lon[piece], lat[piece];
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        angles_from_normals(normals.subspan(first, n), {lon, n}, {lat, n});
        glm::dvec2* const out = samples.data() + first;
        for (std::size_t i = 0; i < n; ++i) {
            double x = lon[i] * (1 / degrees) - crs_middle_.x;
            x -= 360 * std::floor(x * (1.0 / 360) + 0.5);
            const double y = lat[i] * (1 / degrees) - crs_middle_.y;
            out[i].x = middle_.x + by_x_.x * x + by_y_.x * y;
            out[i].y = middle_.y + by_x_.y * x + by_y_.y * y;
        }
    }
}

void SampleMap::normals_from_samples(std::span<const glm::dvec2> samples, std::span<glm::dvec3> normals) const {
    assert(samples.size() == normals.size());
    if (!transform_) {
        for (std::size_t i = 0; i < samples.size(); ++i)
            normals[i] = normal_from_degrees(grid_.crs_from_sample(samples[i]));
        return;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) normals[i] = glm::normalize((*to_normal_)(samples[i]));
}

void SampleMap::normals_of_row(int first_column, int row, std::span<glm::dvec3> normals) const {
    if (meridians_.empty()) {
        std::vector<glm::dvec2> samples;
        for (std::size_t i = 0; i < normals.size(); ++i)
            samples.emplace_back(first_column + static_cast<double>(i), row);
        return normals_from_samples(samples, normals);
    }
    const double c = parallels_[static_cast<std::size_t>(row)].x, s = parallels_[static_cast<std::size_t>(row)].y;
    const glm::dvec2* const meridian = meridians_.data() + first_column;
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = {c * meridian[i].x, c * meridian[i].y, s};
}

SampleMap::RowsInArea::RowsInArea(const SampleMap& map, int first_column, int columns, const SampleArea& area)
    : map_(map), first_column_(first_column), columns_(columns) {
    if (map.meridians_.empty()) return;
    along_.resize(bounds_.size() * static_cast<std::size_t>(columns));
    if (area.is_cell())
        for (const glm::dvec3& side : area.sides) add(side, 0);
    else
        add(area.cap.centre, std::cos(std::min(area.cap.angle, std::numbers::pi)));
}

void SampleMap::RowsInArea::add(const glm::dvec3& side, double least) {
    constexpr double rounding = 1e-14;  // more than that of any product of two vectors of up to 1
    const std::size_t first = bound_count_ * static_cast<std::size_t>(columns_);
    Bound& bound = bounds_[bound_count_++];
    bound = {.side = side, .least = least - rounding, .first = first};
    const glm::dvec2* const meridian = map_.meridians_.data() + first_column_;
    double* const along = along_.data() + first;
    const auto columns = static_cast<std::size_t>(columns_);
    for (std::size_t i = 0; i < columns; ++i) along[i] = meridian[i].x * side.x + meridian[i].y * side.y;
    bound.most_along = *std::max_element(along, along + columns);
    for (std::size_t i = 1; i < columns; ++i) {
        bound.rises &= along[i - 1] <= along[i];
        bound.falls &= along[i - 1] >= along[i];
    }
}

std::pair<int, int> SampleMap::RowsInArea::find(int row) const {
    std::pair<int, int> found{0, columns_};
    if (bound_count_ == 0) return found;
    const glm::dvec2 parallel = map_.parallels_[static_cast<std::size_t>(row)];
    const auto bounds = std::span(bounds_).first(bound_count_);
    for (const Bound& bound : bounds)
        if (parallel.x * bound.most_along < bound.least - parallel.y * bound.side.z) return {0, 0};
    for (const Bound& bound : bounds) {
        const auto [first, last] = find(bound, parallel);
        found = {std::max(found.first, first), std::min(found.second, last)};
    }
    return found.first < found.second ? found : std::pair(0, 0);
}

// Nearly always the meridians' parts rise or fall along a row: then it is enough to count.
std::pair<int, int> SampleMap::RowsInArea::find(const Bound& bound, const glm::dvec2& parallel) const {
    const double* const along = along_.data() + bound.first;
    const double rest = bound.least - parallel.y * bound.side.z;
    const auto columns = static_cast<std::size_t>(columns_);
    if (bound.rises || bound.falls) {
        std::int64_t outside = 0;
        for (std::size_t i = 0; i < columns; ++i) outside += parallel.x * along[i] < rest ? 1 : 0;
        const int count = static_cast<int>(outside);
        return bound.rises ? std::pair(count, columns_) : std::pair(0, columns_ - count);
    }
    std::size_t first = 0, last = columns;
    while (first < last && parallel.x * along[first] < rest) ++first;
    while (last > first && parallel.x * along[last - 1] < rest) --last;
    return {static_cast<int>(first), static_cast<int>(last)};
}

void SampleMap::project_exactly(std::span<const glm::dvec3> normals, std::span<glm::dvec3> samples) const {
    std::vector<double> lon(normals.size()), lat(normals.size());
    angles_from_normals(normals, lon, lat);
    std::vector<glm::dvec2> points(normals.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = glm::dvec2(lon[i], lat[i]) / degrees;
    transform_->crs_from_geodetic(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec2 d = points[i] - crs_middle_;
        samples[i] = glm::dvec3(middle_ + by_x_ * d.x + by_y_ * d.y, 0);
        if (std::isnan(samples[i].x + samples[i].y)) samples[i] = glm::dvec3(nan);
    }
}

void SampleMap::unproject_exactly(std::span<const glm::dvec2> samples, std::span<glm::dvec3> normals) const {
    std::vector<glm::dvec2> points(samples.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = grid_.crs_from_sample(samples[i]);
    transform_->geodetic_from_crs(points);
    for (std::size_t i = 0; i < points.size(); ++i) normals[i] = normal_from_degrees(points[i]);
}

void SampleMap::build_patches() {
    // Where on the cube the raster is, from a lattice of its own positions.
    constexpr int steps = 64;
    std::vector<glm::dvec2> at;
    for (int j = 0; j <= steps; ++j)
        for (int i = 0; i <= steps; ++i) at.push_back(size_ * glm::dvec2(i, j) / double{steps} - 0.5);
    std::vector<glm::dvec3> normals(at.size());
    unproject_exactly(at, normals);
    double step = 0;  // the longest way between neighbours of the lattice, as a chord
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const auto longer = [&](std::size_t other) {
            const double d = glm::distance(normals[k], normals[other]);
            if (d > step && d < 0.5) step = d;  // a longer one jumps across a cut
        };
        if (k % (steps + 1) != steps) longer(k + 1);
        if (k + steps + 1 < normals.size()) longer(k + steps + 1);
    }
    const double margin = 3 * step + 1e-9;  // gnomonic coordinates change by at most 3 a unit of angle

    const glm::dvec2 inf(std::numeric_limits<double>::infinity());
    for (std::size_t face = 0; face < 6; ++face) {
        glm::dvec2 low = inf, high = -inf;
        for (const glm::dvec3& n : normals) {
            const double towards = n[static_cast<int>(face / 2)] * (face % 2 != 0 ? -1 : 1);
            if (!(towards > 0.3)) continue;
            const glm::dvec2 uv = face_coordinates(n, face);
            if (std::abs(uv.x) > 1 + margin || std::abs(uv.y) > 1 + margin) continue;
            low = glm::min(low, uv - margin);
            high = glm::max(high, uv + margin);
        }
        if (!(low.x < high.x)) continue;
        const auto function = [this, face](std::span<const glm::dvec2> uv, std::span<glm::dvec3> samples) {
            std::vector<glm::dvec3> n(uv.size());
            for (std::size_t i = 0; i < uv.size(); ++i) n[i] = normal_from_cube(face, uv[i]);
            project_exactly(n, samples);
        };
        from_cube_[face].emplace(glm::max(low, glm::dvec2(-1)), glm::min(high, glm::dvec2(1)), function, 1.0 / 256);
    }

    const glm::dvec2 beside[2] = {middle_ - 0.5, middle_ + 0.5};
    glm::dvec3 n[2];
    unproject_exactly(beside, n);
    const double sample = glm::distance(n[0], n[1]) / std::numbers::sqrt2;
    const double tolerance = sample > 0 ? std::max(sample / 256, 1e-13) : 1e-9;
    const auto function = [this](std::span<const glm::dvec2> s, std::span<glm::dvec3> out) {
        unproject_exactly(s, out);
    };
    to_normal_.emplace(glm::dvec2(-0.5), size_ - 0.5, function, tolerance);
}

}  // namespace planet
