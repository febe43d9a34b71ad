#include "planet/patches/patch_measure.h"

#include <cmath>
#include <cstring>

#include "planet/parallel.h"
#include "planet/patches/triangle_rows.h"

namespace planet {

namespace {

using Corners2 = std::array<glm::ivec2, 3>;

std::int64_t cross(glm::ivec2 a, glm::ivec2 b) {
    return static_cast<std::int64_t>(a.x) * b.y - static_cast<std::int64_t>(a.y) * b.x;
}

// Rows of any triangle with corners on samples: what cutting at the border leaves has sides of any slope.
struct AnyRows {
    explicit AnyRows(const Corners2& corner) : c(corner) {
        if (cross(c[1] - c[0], c[2] - c[0]) < 0) std::swap(c[1], c[2]);
    }
    int bottom() const { return std::min({c[0].y, c[1].y, c[2].y}); }
    int top() const { return std::max({c[0].y, c[1].y, c[2].y}); }
    RowSpan at(int y) const {
        RowSpan span{std::min({c[0].x, c[1].x, c[2].x}), std::max({c[0].x, c[1].x, c[2].x})};
        while (span.first <= span.last && !holds({span.first, y})) ++span.first;
        while (span.last >= span.first && !holds({span.last, y})) --span.last;
        return span;
    }
    bool holds(glm::ivec2 p) const {
        return cross(c[1] - c[0], p - c[0]) >= 0 && cross(c[2] - c[1], p - c[1]) >= 0 &&
               cross(c[0] - c[2], p - c[2]) >= 0;
    }
    Corners2 c;
};

bool is_cell(const Corners2& c) {
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::ivec2 d = glm::abs(c[(k + 1) % 3] - c[k]);
        if (d.x != 0 && d.y != 0 && d.x != d.y) return false;
    }
    return true;
}

class Measurer {
  public:
    Measurer(const PatchRaster& raster, std::size_t triangles)
        : raster_(raster),
          counted_((static_cast<std::size_t>(raster.width()) * static_cast<std::size_t>(raster.height()) + 63) / 64) {
        out_.by_triangle.reserve(triangles);
    }

    // distance(x, y, height) in metres, of a sample that is not void.
    template <class Distance>
    void triangle(const Corners2& c, Distance&& distance) {
        worst_ = 0;
        if (is_cell(c))
            rows(TriangleRows({c[0], c[1], c[2]}), distance);
        else
            rows(AnyRows(c), distance);
        out_.max = std::max(out_.max, worst_);
        const auto f = static_cast<float>(worst_);
        out_.by_triangle.push_back(static_cast<double>(f) < worst_ ? std::nextafter(f, 1e30f) : f);
    }

    AchievedDeviation result() {
        out_.uncovered = raster_.valid_samples() - out_.samples;
        out_.rms = out_.samples == 0 ? 0 : std::sqrt(squares_ / static_cast<double>(out_.samples));
        return std::move(out_);
    }

  private:
    template <class Rows, class Distance>
    void rows(const Rows& rows, Distance& distance) {
        for (int y = rows.bottom(); y <= rows.top(); ++y) {
            const RowSpan span = rows.at(y);
            const float* heights = raster_.row(y);
            std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(raster_.width()) +
                            static_cast<std::size_t>(span.first);
            for (int x = span.first; x <= span.last; ++x, ++i) {
                if (std::isnan(heights[x])) continue;
                const double t = distance(x, y, static_cast<double>(heights[x]), i);
                worst_ = std::max(worst_, std::abs(t));
                std::uint64_t& word = counted_[i >> 6];
                const std::uint64_t bit = std::uint64_t{1} << (i & 63);
                if (word & bit) continue;
                word |= bit;
                ++out_.samples;
                squares_ += t * t;
            }
        }
    }

    const PatchRaster& raster_;
    std::vector<std::uint64_t> counted_;  ///< a bit for each sample
    AchievedDeviation out_;
    double squares_ = 0, worst_ = 0;
};

// The plane through written points, as a function of column and row: exact up to rounding where x and y are affine in
// them. With the places of three samples (0, 0), (1, 0), (0, 1) as the axes.
struct LatticePlane {
    LatticePlane(const std::array<glm::dvec3, 3>& p, const SampleGrid& grid, glm::ivec2 at) : corner(at) {
        const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
        const glm::dvec2 slope(-n.x / n.z, -n.y / n.z);
        per_column = glm::dot(slope, grid.per_column);
        per_row = glm::dot(slope, grid.per_row);
        height = p[0].z + glm::dot(slope, grid.crs_from_sample(at) - glm::dvec2(p[0]));
    }
    double at(int x, int y) const { return height + per_column * (x - corner.x) + per_row * (y - corner.y); }
    glm::ivec2 corner;
    double height, per_column, per_row;
};

}  // namespace

PlacedSamples place_samples(const PatchRaster& raster, const RasterFrame& frame) {
    const auto w = static_cast<std::size_t>(raster.width()), h = static_cast<std::size_t>(raster.height());
    PlacedSamples samples{std::vector<glm::dvec3>(w * h), std::vector<glm::vec3>(w * h)};
    parallel_for(h, 0, [&](std::size_t y) {
        std::vector<glm::dvec2> at(w);
        std::vector<double> heights(w);
        for (std::size_t x = 0; x < w; ++x) {
            at[x] = glm::dvec2(static_cast<double>(x), static_cast<double>(y));
            heights[x] = static_cast<double>(raster.row(static_cast<int>(y))[x]);
        }
        frame.place(at, heights, std::span(samples.position).subspan(y * w, w),
                    std::span(samples.up).subspan(y * w, w));
    });
    return samples;
}

std::vector<glm::dvec3> place_vertices(const PatchMesh& mesh, const RasterFrame& frame) {
    std::vector<glm::dvec3> placed(mesh.vertices.size());
    constexpr std::size_t piece = 65536;
    parallel_for((placed.size() + piece - 1) / piece, 0, [&](std::size_t k) {
        const std::size_t begin = k * piece, n = std::min(piece, placed.size() - begin);
        std::vector<glm::dvec2> at(n);
        std::vector<double> heights(n);
        for (std::size_t i = 0; i < n; ++i) {
            at[i] = glm::dvec2(mesh.vertices[begin + i].at);
            heights[i] = mesh.vertices[begin + i].height;
        }
        frame.place(at, heights, std::span(placed).subspan(begin, n), {});
    });
    return placed;
}

AchievedDeviation measure(const PatchMesh& mesh, std::span<const glm::dvec3> written, const PatchRaster& raster,
                          const RasterFrame& frame, const PlacedSamples* samples) {
    Measurer measurer(raster, mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
        const Corners2 c{mesh.vertices[t[0]].at, mesh.vertices[t[1]].at, mesh.vertices[t[2]].at};
        const std::array<glm::dvec3, 3> p{written[t[0]], written[t[1]], written[t[2]]};
        if (frame.affine()) {
            const LatticePlane plane(p, frame.grid(), c[0]);
            measurer.triangle(c, [&](int x, int y, double height, std::size_t) { return plane.at(x, y) - height; });
        } else {
            const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
            measurer.triangle(c, [&](int, int, double, std::size_t i) {
                return glm::dot(p[0] - samples->position[i], n) / glm::dot(glm::dvec3(samples->up[i]), n);
            });
        }
    }
    return measurer.result();
}

}  // namespace planet
