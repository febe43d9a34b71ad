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

constexpr std::size_t width = 8;
typedef double Lanes __attribute__((vector_size(width * sizeof(double))));
constexpr Lanes ramp{0, 1, 2, 3, 4, 5, 6, 7};

// What a triangle's samples amount to.
struct Sum {
    double worst = 0, squares = 0;
    std::size_t samples = 0;
};

// Rows of any triangle with corners on samples: what cutting at the border leaves has sides of any slope.
struct AnyRows {
    explicit AnyRows(const Corners2& corner) : c(corner) {
        if (cross(c[1] - c[0], c[2] - c[0]) < 0) std::swap(c[1], c[2]);
    }
    int bottom() const { return std::min({c[0].y, c[1].y, c[2].y}); }
    int top() const { return std::max({c[0].y, c[1].y, c[2].y}); }
    RowSpan at(int y) const {
        RowSpan span{std::min({c[0].x, c[1].x, c[2].x}), std::max({c[0].x, c[1].x, c[2].x})};
        while (span.first <= span.last && !holds({span.first, y}, {0, 0})) ++span.first;
        while (span.last >= span.first && !holds({span.last, y}, {0, 0})) --span.last;
        return span;
    }
    // Whether the triangle holds what lies from p a step away along x, and a much smaller one along y.
    bool holds(glm::ivec2 p, glm::ivec2 step) const {
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 side = c[(k + 1) % 3] - c[k];
            const std::int64_t left = cross(side, p - c[k]);
            const std::int64_t by_x = -static_cast<std::int64_t>(side.y) * step.x,
                               by_y = static_cast<std::int64_t>(side.x) * step.y;
            if ((left != 0 ? left : by_x != 0 ? by_x : by_y) < 0) return false;
        }
        return true;
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

// A raster without voids: every sample is in the triangle a little to its right and above (to its left at the last
// column, below at the last row), and in no other. So triangles can be summed apart.
class WholeRaster {
  public:
    explicit WholeRaster(const PatchRaster& raster) : raster_(raster) {}

    // distances(x, y, count, i) of eight samples from sample (x, y), number i, on.
    template <class Distances>
    Sum triangle(const Corners2& c, Distances&& distances) const {
        return is_cell(c) ? cell(TriangleRows({c[0], c[1], c[2]}), distances) : any(AnyRows(c), distances);
    }

  private:
    template <class Distances>
    Sum cell(const TriangleRows& rows, Distances& distances) const {
        Lanes worst{}, squares{};
        Sum sum;
        for (int y = rows.bottom(); y <= rows.top(); ++y) {
            const RowSpan span = rows.at(y);
            const RowSpan beside = y == raster_.height() - 1 ? rows.just_below(y) : rows.just_above(y);
            const bool reaches_last_column = beside.last == raster_.width() - 1 && beside.first < beside.last;
            const int first = beside.first, last = reaches_last_column ? beside.last : beside.last - 1;  // its own ones
            sum.samples += static_cast<std::size_t>(std::max(0, last - first + 1));
            for (int x = span.first; x <= span.last; x += static_cast<int>(width)) {
                const Lanes t = distances(x, y);
                const Lanes at = ramp + static_cast<double>(x), size = t < 0 ? -t : t;
                worst = (size > worst) & (at <= static_cast<double>(span.last)) ? size : worst;
                const auto counted = (at >= static_cast<double>(first)) & (at <= static_cast<double>(last));
                squares += counted ? t * t : Lanes{};
            }
        }
        for (std::size_t w = 0; w < width; ++w) {
            sum.worst = std::max(sum.worst, worst[w]);
            sum.squares += squares[w];
        }
        return sum;
    }

    template <class Distances>
    Sum any(const AnyRows& rows, Distances& distances) const {
        Sum sum;
        for (int y = rows.bottom(); y <= rows.top(); ++y) {
            const RowSpan span = rows.at(y);
            for (int x = span.first; x <= span.last; ++x) {
                const double t = distances(x, y)[0];
                sum.worst = std::max(sum.worst, std::abs(t));
                const glm::ivec2 step(x == raster_.width() - 1 ? -1 : 1, y == raster_.height() - 1 ? -1 : 1);
                if (!rows.holds({x, y}, step)) continue;
                sum.squares += t * t;
                ++sum.samples;
            }
        }
        return sum;
    }

    const PatchRaster& raster_;
};

// A raster with voids: triangles are missing, so each sample is marked by the first that holds it.
class MarkedRaster {
  public:
    explicit MarkedRaster(const PatchRaster& raster)
        : raster_(raster),
          counted_((static_cast<std::size_t>(raster.width()) * static_cast<std::size_t>(raster.height()) + 63) / 64) {}

    template <class Distances>
    Sum triangle(const Corners2& c, Distances&& distances) {
        return is_cell(c) ? rows(TriangleRows({c[0], c[1], c[2]}), distances) : rows(AnyRows(c), distances);
    }

  private:
    template <class Rows, class Distances>
    Sum rows(const Rows& rows, Distances& distances) {
        Sum sum;
        for (int y = rows.bottom(); y <= rows.top(); ++y) {
            const RowSpan span = rows.at(y);
            for (int x = span.first; x <= span.last; ++x) {
                const double t = distances(x, y)[0];
                if (std::isnan(t)) continue;
                sum.worst = std::max(sum.worst, std::abs(t));
                const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(raster_.width()) +
                                      static_cast<std::size_t>(x);
                std::uint64_t& word = counted_[i >> 6];
                const std::uint64_t bit = std::uint64_t{1} << (i & 63);
                if (word & bit) continue;
                word |= bit;
                ++sum.samples;
                sum.squares += t * t;
            }
        }
        return sum;
    }

    const PatchRaster& raster_;
    std::vector<std::uint64_t> counted_;  ///< a bit for each sample
};

Lanes load(const float* heights) {
    typedef float Floats __attribute__((vector_size(width * sizeof(float))));
    Floats f;
    std::memcpy(&f, heights, sizeof f);
    return __builtin_convertvector(f, Lanes);
}

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

PlacedSamples place_samples(const PatchRaster& raster, const RasterFrame& frame,
                            const std::function<void(double)>& progress) {
    const auto w = static_cast<std::size_t>(raster.width()), h = static_cast<std::size_t>(raster.height());
    PlacedSamples samples{std::vector<glm::dvec3>(w * h), std::vector<glm::vec3>(w * h)};
    parallel_for(h, 0, progress, [&](std::size_t y) {
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

namespace {

// Of one triangle of the mesh.
template <class Way>
Sum measure_triangle(Way& way, const Corners2& c, const std::array<glm::dvec3, 3>& p, const PatchRaster& raster,
                     const RasterFrame& frame, const PlacedSamples* samples) {
    if (frame.affine()) {
        const LatticePlane plane(p, frame.grid(), c[0]);
        return way.triangle(
            c, [&](int x, int y) { return plane.at(x, y) + plane.per_column * ramp - load(raster.row(y) + x); });
    }
    const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double least_across = 1e-9 * glm::length(n);
    // A triangle that stands upright or has no area, as beside a row at a pole, is no plane to measure from.
    const auto distance = [&](const glm::dvec3& sample, const glm::dvec3& up) {
        const double across = glm::dot(up, n);
        if (std::abs(across) > least_across) return glm::dot(p[0] - sample, n) / across;
        return std::min({glm::distance(sample, p[0]), glm::distance(sample, p[1]), glm::distance(sample, p[2])});
    };
    const auto columns = static_cast<std::size_t>(raster.width()), count = samples->position.size();
    return way.triangle(c, [&](int x, int y) {
        Lanes t{};
        const std::size_t i = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
        for (std::size_t w = 0; w < std::min(width, count - i); ++w)
            t[w] = distance(samples->position[i + w], glm::dvec3(samples->up[i + w]));
        return t;
    });
}

template <class Way>
Sum measure_piece(Way& way, std::size_t begin, std::size_t end, const PatchMesh& mesh,
                  std::span<const glm::dvec3> written, const PatchRaster& raster, const RasterFrame& frame,
                  const PlacedSamples* samples, double* by_triangle) {
    Sum sum;
    for (std::size_t i = begin; i < end; ++i) {
        const auto& t = mesh.triangles[i];
        const Sum one = measure_triangle(way, {mesh.vertices[t[0]].at, mesh.vertices[t[1]].at, mesh.vertices[t[2]].at},
                                         {written[t[0]], written[t[1]], written[t[2]]}, raster, frame, samples);
        by_triangle[i] = one.worst;
        sum.worst = std::max(sum.worst, one.worst);
        sum.squares += one.squares;
        sum.samples += one.samples;
    }
    return sum;
}

}  // namespace

AchievedDeviation measure(const PatchMesh& mesh, std::span<const glm::dvec3> written, const PatchRaster& raster,
                          const RasterFrame& frame, const PlacedSamples* samples,
                          const std::function<void(double)>& progress) {
    constexpr std::size_t piece = 4096;
    const std::size_t triangles = mesh.triangles.size(), pieces = (triangles + piece - 1) / piece;
    AchievedDeviation out;
    out.by_triangle.resize(triangles);
    std::vector<Sum> sums(pieces);
    const auto work = [&](auto& way, std::size_t k) {
        sums[k] = measure_piece(way, k * piece, std::min(triangles, (k + 1) * piece), mesh, written, raster, frame,
                                samples, out.by_triangle.data());
    };
    if (raster.has_void()) {
        MarkedRaster way(raster);
        parallel_for(pieces, 1, progress, [&](std::size_t k) { work(way, k); });
    } else {
        parallel_for(pieces, 0, progress, [&](std::size_t k) {
            const WholeRaster way(raster);
            work(way, k);
        });
    }
    double squares = 0;
    for (const Sum& sum : sums) {
        out.max = std::max(out.max, sum.worst);
        out.samples += sum.samples;
        squares += sum.squares;
    }
    out.uncovered = raster.valid_samples() - out.samples;
    out.rms = out.samples == 0 ? 0 : std::sqrt(squares / static_cast<double>(out.samples));
    return out;
}

}  // namespace planet
