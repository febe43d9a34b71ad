#include "planet/tin/written_tin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/parallel.h"
#include "planet/tin/triangle_scan.h"

namespace planet {

namespace {

// Vertices, or triangles, that are worked on at a time.
constexpr std::size_t piece_size = 4096;

std::vector<glm::dvec3> placed(const TinMesh& mesh, const HeightGrid& grid, const RasterFrame& frame) {
    std::vector<glm::dvec3> out(mesh.vertices.size());
    parallel_for((out.size() + piece_size - 1) / piece_size, 0, [&](std::size_t k) {
        const std::size_t begin = k * piece_size, n = std::min(piece_size, out.size() - begin);
        std::vector<glm::dvec2> at(n);
        std::vector<double> heights(n);
        for (std::size_t i = 0; i < n; ++i) {
            at[i] = glm::dvec2(mesh.vertices[begin + i]);
            heights[i] = static_cast<double>(grid.at(mesh.vertices[begin + i]));
        }
        frame.place(at, heights, std::span(out).subspan(begin, n), {});
    });
    return out;
}

// Of the smallest angle of a triangle: the largest of all is that of the smallest.
double cotangent(const std::array<glm::dvec3, 3>& p, const glm::dvec3& metres_per_unit) {
    const glm::dvec3 a = (p[2] - p[1]) * metres_per_unit, b = (p[0] - p[2]) * metres_per_unit,
                     c = (p[1] - p[0]) * metres_per_unit;
    return std::max({-glm::dot(b, c), -glm::dot(c, a), -glm::dot(a, b)}) / glm::length(glm::cross(a, b));
}

// Which of the triangles that hold a sample counts it. Where triangles are missing: the first to ask.
class FirstHolder {
  public:
    explicit FirstHolder(const HeightGrid& grid)
        : width_(static_cast<std::size_t>(grid.width())), marked_((grid.count() + 63) / 64) {}
    bool counts(const std::array<glm::ivec2, 3>&, glm::ivec2 p) {
        const std::size_t i = static_cast<std::size_t>(p.y) * width_ + static_cast<std::size_t>(p.x);
        const std::uint64_t bit = std::uint64_t{1} << (i & 63), before = marked_[i >> 6];
        marked_[i >> 6] = before | bit;
        return (before & bit) == 0;
    }

  private:
    std::size_t width_;
    std::vector<std::uint64_t> marked_;
};

// Where none is: the one that holds what lies a little to the right of the sample and much less above it, or to the
// left in the last column, below in the last row. So triangles can be counted apart.
class HolderBeside {
  public:
    explicit HolderBeside(const HeightGrid& grid) : last_(grid.width() - 1, grid.height() - 1) {}
    bool counts(const std::array<glm::ivec2, 3>& c, glm::ivec2 p) const {
        const int right = p.x == last_.x ? -1 : 1, up = p.y == last_.y ? -1 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 side = c[(k + 1) % 3] - c[k];
            const std::int64_t left = orientation(c[k], c[(k + 1) % 3], p);
            if ((left != 0 ? left : side.y != 0 ? -std::int64_t{side.y} * right : std::int64_t{side.x} * up) < 0)
                return false;
        }
        return true;
    }

  private:
    glm::ivec2 last_;
};

// Samples of one triangle, and their distances.
class TriangleSamples {
  public:
    TriangleSamples(const HeightGrid& grid, const RasterFrame& frame)
        : grid_(grid), frame_(frame), affine_grid_(frame.grid()), metre_(1 / frame.exaggeration()) {}

    // The corners last, which are valid in every TIN.
    void collect(const std::array<glm::ivec2, 3>& c) {
        samples_.clear();
        shared_.clear();
        for_each_span(SortedTriangle(c, {0, 0, 0}), [&](int y, int first, int last) {
            const bool level = y == c[0].y || y == c[1].y || y == c[2].y;  // with a corner, perhaps a side
            for (int x = first; x <= last; ++x) {
                const glm::ivec2 p(x, y);
                if (!grid_.valid(p) || (level && (p == c[0] || p == c[1] || p == c[2]))) continue;
                samples_.push_back(p);
                shared_.push_back(level || x == first || x == last);
            }
            return true;
        });
        samples_.insert(samples_.end(), c.begin(), c.end());
        shared_.resize(samples_.size(), 1);
    }

    void measure(const std::array<glm::dvec3, 3>& p, const std::array<glm::ivec2, 3>& c) {
        distances_.resize(samples_.size());
        const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
        if (!frame_.affine())
            measure_placed(p, n);
        else if (lie_at_samples(p, c))
            measure_in_lattice(c);
        else
            measure_affine(p[0], n, c[0]);
    }

    std::span<const glm::ivec2> samples() const { return samples_; }
    /// Whether another triangle may hold the sample, too: if not, it lies within this one.
    bool may_be_shared(std::size_t i) const { return shared_[i] != 0; }
    std::span<const double> distances() const { return distances_; }

  private:
    bool lie_at_samples(const std::array<glm::dvec3, 3>& p, const std::array<glm::ivec2, 3>& c) const {
        const std::array at{glm::dvec2(c[0]), glm::dvec2(c[1]), glm::dvec2(c[2])};
        std::array<double, 3> heights{};
        std::array<glm::dvec3, 3> unrounded;
        for (std::size_t k = 0; k < 3; ++k) heights[k] = static_cast<double>(grid_.at(c[k]));
        frame_.place(at, heights, unrounded, {});
        return p == unrounded;
    }

    // Weights of corners that are whole numbers: of heights in whole metres what is exactly the tolerance is not a
    // trifle above it, as it is from places in degrees.
    void measure_in_lattice(const std::array<glm::ivec2, 3>& c) {
        const auto height = [this](glm::ivec2 p) { return static_cast<double>(grid_.at(p)); };
        const double area = static_cast<double>(orientation(c[0], c[1], c[2]));
        const std::array h{height(c[0]), height(c[1]), height(c[2])};
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const glm::ivec2 p = samples_[i];
            const double own = height(p);
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k)
                sum += static_cast<double>(orientation(c[(k + 1) % 3], c[(k + 2) % 3], p)) * (h[k] - own);
            distances_[i] = std::abs(sum) / area;
        }
    }

    // The plane as a function of column and row.
    void measure_affine(const glm::dvec3& p, const glm::dvec3& n, glm::ivec2 corner) {
        const SampleGrid& g = affine_grid_;
        const double e = frame_.exaggeration();
        const glm::dvec2 slope(-n.x / n.z, -n.y / n.z);
        const double per_column = glm::dot(slope, g.per_column), per_row = glm::dot(slope, g.per_row);
        const double height = p.z + glm::dot(slope, g.crs_from_sample(corner) - glm::dvec2(p));
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const glm::ivec2 d = samples_[i] - corner;
            const double h = e * static_cast<double>(grid_.at(samples_[i]));
            distances_[i] = metre_ * std::abs(height + per_column * d.x + per_row * d.y - h);
        }
    }

    // Along the vertical of each sample; from the nearest corner where the triangle stands upright or has no area. A
    // corner is measured from where it is written: one that is not rounded is not off at all.
    void measure_placed(const std::array<glm::dvec3, 3>& p, const glm::dvec3& n) {
        const std::size_t count = samples_.size();
        at_.assign(samples_.begin(), samples_.end());
        heights_.resize(count);
        position_.resize(count);
        up_.resize(count);
        for (std::size_t i = 0; i < count; ++i) heights_[i] = static_cast<double>(grid_.at(samples_[i]));
        frame_.place(at_, heights_, position_, up_);
        const double least_across = 1e-9 * glm::length(n);
        for (std::size_t i = 0; i < count; ++i) {
            const double across = glm::dot(glm::dvec3(up_[i]), n);
            const glm::dvec3& on_plane = p[i + 3 < count ? 0 : i + 3 - count];
            distances_[i] =
                metre_ * (std::abs(across) > least_across
                              ? std::abs(glm::dot(on_plane - position_[i], n) / across)
                              : std::min({glm::distance(position_[i], p[0]), glm::distance(position_[i], p[1]),
                                          glm::distance(position_[i], p[2])}));
        }
    }

    const HeightGrid& grid_;
    const RasterFrame& frame_;
    const SampleGrid affine_grid_;
    const double metre_;  ///< of height, in the frame
    std::vector<glm::ivec2> samples_;
    std::vector<std::uint8_t> shared_;
    std::vector<double> distances_, heights_;
    std::vector<glm::dvec2> at_;
    std::vector<glm::dvec3> position_;
    std::vector<glm::vec3> up_;
};

}  // namespace

SurfaceMesh surface_from_tin(const TinMesh& mesh, const HeightGrid& grid, const RasterFrame& frame) {
    SurfaceMesh out;
    out.vertices = placed(mesh, grid, frame);
    out.triangles = mesh.triangles;
    if (frame.mirrored())
        for (auto& t : out.triangles) std::swap(t[1], t[2]);
    out.level.assign(out.triangles.size(), 0);
    return out;
}

HeightGrid heights_above_tangent_plane(const HeightGrid& grid, const RasterFrame& frame, unsigned threads) {
    const auto width = static_cast<std::size_t>(grid.width());
    return {grid.width(), grid.height(), [&](std::span<float> out) {
                parallel_for(static_cast<std::size_t>(grid.height()), threads, [&](std::size_t row) {
                    const int y = static_cast<int>(row);
                    std::vector<glm::dvec2> at(width);
                    std::vector<double> heights(grid.row(y), grid.row(y) + width);
                    std::vector<glm::dvec3> position(width);
                    for (std::size_t x = 0; x < width; ++x) at[x] = glm::dvec2(static_cast<double>(x), y);
                    frame.place(at, heights, position, {});
                    for (std::size_t x = 0; x < width; ++x) out[row * width + x] = static_cast<float>(position[x].z);
                });
                return grid.sample_rounding();
            }};
}

template <class Holder>
WrittenMeasure::Piece WrittenMeasure::measured(std::size_t piece, const TinMesh& mesh,
                                               std::span<const glm::dvec3> written, Holder& holder) {
    Piece out;
    TriangleSamples inside(grid_, frame_);
    const glm::dvec3 metres(frame_.metres_per_unit(), 1);
    const auto width = static_cast<std::size_t>(grid_.width());
    const std::size_t end = std::min(mesh.triangles.size(), (piece + 1) * piece_size);
    for (std::size_t i = piece * piece_size; i < end; ++i) {
        const auto& t = mesh.triangles[i];
        const std::array p{written[t[0]], written[t[1]], written[t[2]]};
        const std::array c{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
        out.cotangent = std::max(out.cotangent, cotangent(p, metres));
        inside.collect(c);
        inside.measure(p, c);
        FarTriangle farthest{static_cast<std::uint32_t>(i), {-1, -1}, 0};
        for (std::size_t k = 0; k < inside.samples().size(); ++k) {
            const double d = inside.distances()[k];
            const glm::ivec2 s = inside.samples()[k];
            if (d > farthest.deviation) farthest = {farthest.triangle, s, d};
            if (inside.may_be_shared(k) && !holder.counts(c, s)) continue;
            out.squares += d * d;
            ++out.samples;
            if (options_.by_sample)
                found_.by_sample[static_cast<std::size_t>(s.y) * width + static_cast<std::size_t>(s.x)] =
                    static_cast<float>(d);
        }
        out.max = std::max(out.max, farthest.deviation);
        if (farthest.deviation > options_.above) out.too_far.push_back(farthest);
    }
    return out;
}

void WrittenMeasure::measure(const TinMesh& mesh, std::span<const glm::dvec3> written) {
    if (options_.by_sample) found_.by_sample.assign(grid_.count(), std::numeric_limits<float>::quiet_NaN());
    pieces_.assign((mesh.triangles.size() + piece_size - 1) / piece_size, {});
    if (grid_.has_void()) {
        FirstHolder holder(grid_);
        for (std::size_t k = 0; k < pieces_.size(); ++k) pieces_[k] = measured(k, mesh, written, holder);
    } else {
        const HolderBeside holder(grid_);
        parallel_for(pieces_.size(), options_.threads,
                     [&](std::size_t k) { pieces_[k] = measured(k, mesh, written, holder); });
    }
    add_up();
}

void WrittenMeasure::measure_again(const TinMesh& mesh, std::span<const glm::dvec3> written,
                                   std::span<const std::uint32_t> changed) {
    if (grid_.has_void()) return measure(mesh, written);  // which triangle counts a sample depends on all before it
    pieces_.resize((mesh.triangles.size() + piece_size - 1) / piece_size);
    std::vector<std::size_t> due;
    for (const std::size_t t : changed)
        if (due.empty() || due.back() != t / piece_size) due.push_back(t / piece_size);
    const HolderBeside holder(grid_);
    parallel_for(due.size(), options_.threads,
                 [&](std::size_t i) { pieces_[due[i]] = measured(due[i], mesh, written, holder); });
    add_up();
}

void WrittenMeasure::add_up() {
    WrittenDeviation sum;
    sum.by_sample = std::move(found_.by_sample);
    double squares = 0;
    double cotangent = 0;
    for (const Piece& piece : pieces_) {
        sum.max = std::max(sum.max, piece.max);
        cotangent = std::max(cotangent, piece.cotangent);
        sum.samples += piece.samples;
        squares += piece.squares;
        sum.too_far.insert(sum.too_far.end(), piece.too_far.begin(), piece.too_far.end());
    }
    sum.angle_min = pieces_.empty() ? 0 : std::atan2(1, cotangent);
    sum.uncovered = grid_.valid_samples() - sum.samples;
    sum.rms = sum.samples == 0 ? 0 : std::sqrt(squares / static_cast<double>(sum.samples));
    found_ = std::move(sum);
}

WrittenDeviation measure_written(const TinMesh& mesh, std::span<const glm::dvec3> written, const HeightGrid& grid,
                                 const RasterFrame& frame, const MeasureOptions& options) {
    WrittenMeasure measure(grid, frame, options);
    measure.measure(mesh, written);
    return measure.take();
}

}  // namespace planet
