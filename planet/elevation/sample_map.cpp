#include "planet/elevation/sample_map.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "planet/frames.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t piece = 256;  // points at a time: their arrays stay in the first-level cache

// Four-quadrant arctangent without branches. The rational approximation on [-tan(pi/8), tan(pi/8)] is that of Moshier's
// Cephes library (atan.c, peak relative error 1.8e-16 on [0, 0.66]).
inline double arctangent(double y, double x) {
    const double a = std::abs(y), b = std::abs(x);
    const double small = a < b ? a : b, large = a < b ? b : a;
    const bool second = small > (std::numbers::sqrt2 - 1) * large;  // past 22.5 degrees: measure from 45
    const double over = second ? small - large : small;
    const double under = second ? small + large : large;
    const double t = over / (under > 1e-300 ? under : 1e-300);
    const double z = t * t;
    const double p =
        (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
         1.228866684490136173410e2) *
            z -
        6.485021904942025371773e1;
    const double q =
        ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
         4.853903996359136964868e2) *
            z +
        1.945506571482613964425e2;
    double angle = t + t * (z * p / q) + (second ? std::numbers::pi / 4 : 0.0);
    angle = a > b ? std::numbers::pi / 2 - angle : angle;
    angle = std::copysign(1.0, x) < 0 ? std::numbers::pi - angle : angle;
    return std::copysign(angle + 0 * (a + b), y);  // NaN and infinities give NaN
}

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

void angles_from_normals(std::span<const glm::dvec3> normals, std::span<double> longitude, std::span<double> latitude) {
    assert(longitude.size() == normals.size() && latitude.size() == normals.size());
    double x[piece], y[piece], z[piece];
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = normals[first + i].x;
            y[i] = normals[first + i].y;
            z[i] = normals[first + i].z;
        }
        double* const lon = longitude.data() + first;
        double* const lat = latitude.data() + first;
        for (std::size_t i = 0; i < n; ++i) lon[i] = arctangent(y[i], x[i]);
        for (std::size_t i = 0; i < n; ++i) lat[i] = arctangent(z[i], std::sqrt(x[i] * x[i] + y[i] * y[i]));
    }
}

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

SampleMap::RowsInCap::RowsInCap(const SampleMap& map, int first_column, int columns, const glm::dvec3& centre,
                                double least_cosine)
    : map_(map),
      columns_(columns),
      towards_pole_(centre.z),
      least_cosine_(least_cosine - 1e-14),
      most_along_(-std::numeric_limits<double>::infinity()) {
    if (map.meridians_.empty()) return;
    along_.reserve(static_cast<std::size_t>(columns));
    for (int i = 0; i < columns; ++i) {
        const glm::dvec2 meridian = map.meridians_[static_cast<std::size_t>(first_column + i)];
        along_.push_back(meridian.x * centre.x + meridian.y * centre.y);
        most_along_ = std::max(most_along_, along_.back());
    }
}

std::pair<int, int> SampleMap::RowsInCap::find(int row) const {
    if (along_.empty()) return {0, columns_};
    const glm::dvec2 parallel = map_.parallels_[static_cast<std::size_t>(row)];
    const double rest = least_cosine_ - parallel.y * towards_pole_;
    if (parallel.x * most_along_ < rest) return {0, 0};
    int first = 0, last = columns_;
    while (first < last && parallel.x * along_[static_cast<std::size_t>(first)] < rest) ++first;
    while (last > first && parallel.x * along_[static_cast<std::size_t>(last - 1)] < rest) --last;
    return {first, last};
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
