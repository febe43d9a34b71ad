#include "planet/patches/patch_deviation.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "planet/parallel.h"
#include "planet/patches/triangle_rows.h"

namespace planet {

namespace {

constexpr std::size_t width = 8;
typedef double Lanes __attribute__((vector_size(width * sizeof(double))));

constexpr int lane_depth = 8;
constexpr std::size_t lane_vertices = 153;  // (16 + 1)(16 + 2) / 2

inline Lanes absolute(Lanes v) {
    typedef std::int64_t Bits __attribute__((vector_size(width * sizeof(std::int64_t))));
    return reinterpret_cast<Lanes>(reinterpret_cast<Bits>(v) & std::numeric_limits<std::int64_t>::max());
}

template <class Mask>
bool any(Mask mask) {
    bool found = false;
    for (std::size_t w = 0; w < width; ++w) found |= mask[w] != 0;
    return found;
}

float rounded_up(double v) {
    const auto f = static_cast<float>(v);
    return static_cast<double>(f) < v ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

// ---- planes, and the samples of a cell row by row ----

struct Plane {
    double at_origin, per_x, per_y;  // of the lattice
    double at(glm::ivec2 p) const { return at_origin + per_x * p.x + per_y * p.y; }
    double along(glm::ivec2 step) const { return per_x * step.x + per_y * step.y; }
};

Plane plane_through(const PatchRaster& raster, const LatticeCorners& c) {
    const double a = static_cast<double>(raster.at(c.left)), b = static_cast<double>(raster.at(c.right)),
                 h = static_cast<double>(raster.at(c.apex));
    const glm::dvec2 u(c.right - c.left), v(c.apex - c.left);
    const double area = u.x * v.y - u.y * v.x;  // a power of two: exact
    const double per_x = ((b - a) * v.y - (h - a) * u.y) / area, per_y = ((h - a) * u.x - (b - a) * v.x) / area;
    return {a - per_x * c.left.x - per_y * c.left.y, per_x, per_y};
}

// The largest distance of a sample in the cell from a plane. NaN, a void sample, leaves the maximum as it is.
double worst_in_cell(const PatchRaster& raster, const LatticeCorners& cell, const Plane& plane) {
    if (raster.outside(cell)) return 0;
    const TriangleRows rows(cell);
    double worst = 0;
    for (int y = rows.bottom(); y <= std::min(rows.top(), raster.height() - 1); ++y) {
        const RowSpan span = rows.at(y);
        for (int x = span.first; x <= std::min(span.last, raster.width() - 1); ++x) {
            const double t = std::abs(plane.at({x, y}) - static_cast<double>(raster.row(y)[x]));
            worst = t > worst ? t : worst;
        }
    }
    return worst;
}

// Of a level, by cell.
std::vector<Plane> planes_of_level(const PatchRaster& raster, int level, std::size_t cells, unsigned threads) {
    std::vector<Plane> planes(cells);
    const CellCode base = CellCode{1} << (raster.grid().root_bits() + level);
    constexpr std::size_t piece = 4096;
    parallel_for((cells + piece - 1) / piece, threads, [&](std::size_t k) {
        for (std::size_t i = k * piece; i < std::min(cells, (k + 1) * piece); ++i)
            planes[i] = plane_through(raster, raster.lattice().corners(base + i));
    });
    return planes;
}

// ---- small cells: lanes ----

// Barycentric coordinates of a vertex in a cell, in `whole`ths.
struct Barycentric {
    int left, right, apex;
    double right_share = right, apex_share = apex;
    friend bool operator==(const Barycentric& a, const Barycentric& b) {
        return a.left == b.left && a.right == b.right && a.apex == b.apex;
    }
};
constexpr int whole = 1 << (lane_depth / 2);

// The vertices of a cell by its depth (bisections down to unit cells) but the corners; and by child, where each vertex of
// the child is among the parent's, with the weight of the parent's split vertex.
struct CellLayout {
    struct Source {
        std::uint32_t parent;
        double hat;
    };
    std::vector<Barycentric> vertices;
    std::size_t split = 0;  ///< index of the split vertex
    std::array<std::vector<Source>, 2> child;
};

Barycentric in_parent(const Barycentric& v, unsigned child) {
    const int half = v.apex / 2;
    return child == 0 ? Barycentric{v.left + half, half, v.right} : Barycentric{half, v.right + half, v.left};
}

std::array<CellLayout, lane_depth + 1> make_layouts() {
    std::array<CellLayout, lane_depth + 1> all;
    for (std::size_t depth = 1; depth <= lane_depth; ++depth) {
        CellLayout& cell = all[depth];
        const Barycentric split{whole / 2, whole / 2, 0};
        cell.vertices = {split};
        for (unsigned child = 0; child < 2; ++child)
            for (const Barycentric& v : all[depth - 1].vertices) {
                const Barycentric p = in_parent(v, child);
                const auto at = std::find(cell.vertices.begin(), cell.vertices.end(), p);
                cell.child[child].push_back(
                    {static_cast<std::uint32_t>(at - cell.vertices.begin()), static_cast<double>(v.apex) / whole});
                if (at == cell.vertices.end()) cell.vertices.push_back(p);
            }
    }
    return all;
}

const std::array<CellLayout, lane_depth + 1>& layouts() {
    static const auto all = make_layouts();
    return all;
}

// Eight cells of one level, all below them, and what they add to those above them.
class LaneCells {
  public:
    // @param planes by level above the lanes' and cell
    LaneCells(const PatchRaster& raster, int depth, const std::vector<std::vector<Plane>>& planes,
              DenseQuadtree<float>& out)
        : raster_(raster),
          depth_(depth),
          level_(raster.lattice().bisection_levels() - depth),
          planes_(planes),
          out_(out) {}

    // The cells number first .. first + width - 1 of the level, as far as there are so many.
    void measure(std::size_t first, std::size_t count) {
        first_ = first;
        lanes_ = std::min(width, count - first);
        const CellCode base = CellCode{1} << (raster_.grid().root_bits() + level_);
        bool clipped = false, empty = true;
        for (std::size_t w = 0; w < width; ++w) {
            corners_[w] = raster_.lattice().corners(base + first + std::min(w, lanes_ - 1));
            clipped |= !raster_.inside(corners_[w]);
            empty &= raster_.outside(corners_[w]);
        }
        if (empty) {
            for (int level = 0; level < depth_; ++level) {
                auto cells = out_.level(level_ + level);
                std::fill_n(cells.begin() + static_cast<std::ptrdiff_t>(first_ << level), lanes_ << level, 0.0f);
            }
        } else if (const Lanes worst = clipped ? gather<true>() : gather<false>(); has_void_) {
            for (int level = 0; level < depth_; ++level) by_rows(level);
            above_by_rows();
        } else if (clipped) {
            cell<true>(depth_, 0, 0, worst);
            above<true>();
        } else {
            cell<false>(depth_, 0, 0, worst);
            above<false>();
        }
    }

  private:
    // Residuals against the cells' own planes; count 0 marks padding. Returns the worst.
    template <bool clipped>
    Lanes gather() {
        const auto& vertices = layouts()[static_cast<std::size_t>(depth_)].vertices;
        auto& residual = residual_[static_cast<std::size_t>(depth_)];
        auto& counts = counts_[static_cast<std::size_t>(depth_)];
        // Of lattice index and height, at the left corner and by a step along the split side and the left leg.
        typedef std::int32_t Indices __attribute__((vector_size(width * sizeof(std::int32_t))));
        Indices index{}, index_right{}, index_apex{};
        for (std::size_t w = 0; w < width; ++w) {
            const LatticeCorners& c = corners_[w];
            right_[w] = (c.right - c.left) / whole_of_cell();
            apex_[w] = (c.apex - c.left) / whole_of_cell();
            index[w] = c.left.y * raster_.width() + c.left.x;
            index_right[w] = right_[w].y * raster_.width() + right_[w].x;
            index_apex[w] = apex_[w].y * raster_.width() + apex_[w].x;
            plane_[w] = static_cast<double>(raster_.at(c.left));
            plane_right_[w] = (static_cast<double>(raster_.at(c.right)) - plane_[w]) / whole_of_cell();
            plane_apex_[w] = (static_cast<double>(raster_.at(c.apex)) - plane_[w]) / whole_of_cell();
        }
        has_void_ = any(plane_ != plane_) || any(plane_right_ != plane_right_) || any(plane_apex_ != plane_apex_);
        Lanes worst{};
        const float* heights = raster_.row(0);
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            const int right = vertices[v].right * whole_of_cell() / whole,
                      apex = vertices[v].apex * whole_of_cell() / whole;
            Lanes height{};
            if constexpr (clipped) {
                for (std::size_t w = 0; w < width; ++w) {
                    const LatticeCorners& c = corners_[w];
                    const glm::ivec2 p =
                        c.left + ((c.right - c.left) * right + (c.apex - c.left) * apex) / whole_of_cell();
                    height[w] = static_cast<double>(raster_.at(p));
                    counts[v][w] = raster_.inside(p) ? 1 : 0;
                }
            } else {
                const Indices at = index + index_right * right + index_apex * apex;
                for (std::size_t w = 0; w < width; ++w) height[w] = static_cast<double>(heights[at[w]]);
            }
            has_void_ |= any(height != height);
            residual[v] = height - (plane_ + plane_right_ * right + plane_apex_ * apex);
            worst = larger(worst, clipped ? residual[v] * counts[v] : residual[v]);
        }
        return worst;
    }

    // A void split vertex would leave its descendants without residuals.
    void by_rows(int level) {
        const auto cells = out_.level(level_ + level);
        const CellCode base = CellCode{1} << (raster_.grid().root_bits() + level_ + level);
        for (std::size_t i = first_ << level; i < (first_ + lanes_) << level; ++i) {
            const LatticeCorners c = raster_.lattice().corners(base + i);
            cells[i] = rounded_up(worst_in_cell(raster_, c, plane_through(raster_, c)));
        }
    }

    static Lanes larger(Lanes worst, Lanes residual) {
        const Lanes t = absolute(residual);
        return t > worst ? t : worst;
    }

    // The lanes' samples against the planes of the cells above: their residuals, and the difference of two planes.
    template <bool clipped>
    void above() {
        int level = level_;
        for (; level >= 4; level -= 4) above_by<clipped, 4>(level);
        for (; level >= 1; --level) above_by<clipped, 1>(level);
    }
    // Of `count` levels above `level` at once: a maximum waits for the one before it.
    template <bool clipped, int count>
    void above_by(int level) {
        const double scale = static_cast<double>(whole_of_cell()) / whole;
        Lanes at[count], right[count], apex[count], worst[count];
        for (int k = 0; k < count; ++k) {
            for (std::size_t w = 0; w < width; ++w) {
                const Plane& plane = planes_[static_cast<std::size_t>(level - 1 - k)][above_lane(w, level - 1 - k)];
                at[k][w] = plane_[w] - plane.at(corners_[w].left);
                right[k][w] = (plane_right_[w] - plane.along(right_[w])) * scale;
                apex[k][w] = (plane_apex_[w] - plane.along(apex_[w])) * scale;
            }
            worst[k] = worst_of_corners<clipped>(at[k], at[k] + right[k] * whole, at[k] + apex[k] * whole);
        }
        const auto& vertices = layouts()[static_cast<std::size_t>(depth_)].vertices;
        const auto& residual = residual_[static_cast<std::size_t>(depth_)];
        const auto& counts = counts_[static_cast<std::size_t>(depth_)];
        for (std::size_t v = 0; v < vertices.size(); ++v)
            for (int k = 0; k < count; ++k) {
                const Lanes t =
                    residual[v] + (at[k] + right[k] * vertices[v].right_share + apex[k] * vertices[v].apex_share);
                worst[k] = larger(worst[k], clipped ? t * counts[v] : t);
            }
        for (int k = 0; k < count; ++k)
            for (std::size_t w = 0; w < lanes_; ++w) raise(level - 1 - k, w, worst[k][w]);
    }
    template <bool clipped>
    Lanes worst_of_corners(Lanes left, Lanes right, Lanes apex) const {
        if (clipped)
            for (std::size_t w = 0; w < width; ++w) {
                if (!raster_.inside(corners_[w].left)) left[w] = 0;
                if (!raster_.inside(corners_[w].right)) right[w] = 0;
                if (!raster_.inside(corners_[w].apex)) apex[w] = 0;
            }
        return larger(larger(absolute(left), right), apex);
    }
    void above_by_rows() {
        for (int level = level_ - 1; level >= 0; --level)
            for (std::size_t w = 0; w < lanes_; ++w)
                raise(level, w,
                      worst_in_cell(raster_, corners_[w],
                                    planes_[static_cast<std::size_t>(level)][above_lane(w, level)]));
    }
    std::size_t above_lane(std::size_t w, int level) const {
        return (first_ + std::min(w, lanes_ - 1)) >> (level_ - level);
    }
    // The largest of all lanes below a cell, whichever thread has them.
    void raise(int level, std::size_t lane, double worst) {
        const std::atomic_ref<float> cell(out_.level(level)[above_lane(lane, level)]);
        const float value = rounded_up(worst);
        float now = cell.load(std::memory_order_relaxed);
        while (value > now && !cell.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
        }
    }

    LatticeCorners corners_below(std::size_t lane, int level, std::size_t number) const {
        LatticeCorners c = corners_[lane];
        for (int i = level - 1; i >= 0; --i) c = PatchLattice::child(c, number >> i & 1);
        return c;
    }

    int whole_of_cell() const { return 1 << (depth_ / 2); }

    template <bool clipped>
    void cell(int depth, int level, std::size_t number, Lanes worst) {
        const auto d = static_cast<std::size_t>(depth);
        float* out = out_.level(level_ + level).data() + (first_ << level) + number;
        for (std::size_t w = 0; w < lanes_; ++w)
            out[w << level] = clipped && raster_.outside(corners_below(w, level, number)) ? 0 : rounded_up(worst[w]);
        if (depth == 1) return;
        const CellLayout& layout = layouts()[d];
        const Lanes* r = residual_[d].data();
        const Lanes middle = r[layout.split];
        for (std::size_t i = 0; i < 2; ++i) {
            const auto& sources = layout.child[i];
            Lanes* below = residual_[d - 1].data();
            Lanes worst_below{};
            for (std::size_t v = 0; v < sources.size(); ++v) {
                below[v] = r[sources[v].parent] - middle * sources[v].hat;
                if (clipped) counts_[d - 1][v] = counts_[d][sources[v].parent];
                worst_below = larger(worst_below, clipped ? below[v] * counts_[d - 1][v] : below[v]);
            }
            cell<clipped>(depth - 1, level + 1, 2 * number + i, worst_below);
        }
    }

    const PatchRaster& raster_;
    const int depth_, level_;
    const std::vector<std::vector<Plane>>& planes_;
    DenseQuadtree<float>& out_;
    std::size_t first_ = 0, lanes_ = 0;
    bool has_void_ = false;
    std::array<LatticeCorners, width> corners_{};
    std::array<glm::ivec2, width> right_{}, apex_{};  ///< a step along the split side, and along the left leg
    Lanes plane_{}, plane_right_{}, plane_apex_{};    ///< at the left corner, and along those steps
    std::array<std::array<Lanes, lane_vertices>, lane_depth + 1> residual_, counts_;
};

// Cells of padding that touch the raster's border have samples of it.
void clear_padding(const PatchRaster& raster, int levels, DenseQuadtree<float>& out) {
    for (int level = 0; level < levels; ++level) {
        const auto cells = out.level(level);
        const CellCode base = CellCode{1} << (raster.grid().root_bits() + level);
        for (std::size_t i = 0; i < cells.size(); ++i)
            if (cells[i] > 0 && raster.outside(raster.lattice().corners(base + i))) cells[i] = 0;
    }
}

// ---- void samples ----

struct VoidState {
    bool any_void, any_valid;
};

// Marks the cells that mix; what is wholly void needs no triangle and has deviation 0.
VoidState mark_mixed(const PatchRaster& raster, CellCode cell, int level, const LatticeCorners& c,
                     DenseQuadtree<float>& out) {
    if (level == out.levels()) {
        VoidState state{false, false};
        for (const glm::ivec2 p : {c.left, c.right, c.apex})
            (std::isnan(raster.at(p)) ? state.any_void : state.any_valid) = true;
        return state;
    }
    VoidState state{false, false};
    for (unsigned i = 0; i < 2; ++i) {
        const VoidState s = mark_mixed(raster, cell << 1 | i, level + 1, PatchLattice::child(c, i), out);
        state.any_void |= s.any_void;
        state.any_valid |= s.any_valid;
    }
    if (state.any_void) out[cell] = state.any_valid && !raster.outside(c) ? mixed_with_void : 0;
    return state;
}

}  // namespace

DenseQuadtree<float> patch_deviations(const PatchRaster& raster, unsigned threads,
                                      const std::function<void(double)>& progress) {
    const PatchLattice& lattice = raster.lattice();
    const PatchGrid& grid = raster.grid();
    const int levels = lattice.bisection_levels();
    DenseQuadtree<float> out(grid.root_bits(), grid.root_count(), levels);
    const int depth = std::min(lane_depth, levels);
    if (depth == 0) return out;

    std::vector<std::vector<Plane>> planes;
    for (int level = 0; level < levels - depth; ++level) {
        const auto cells = out.level(level);
        planes.push_back(planes_of_level(raster, level, cells.size(), threads));
        std::fill(cells.begin(), cells.end(), 0.0f);
    }
    const std::size_t lane_cells = static_cast<std::size_t>(grid.root_count()) << (levels - depth);
    constexpr std::size_t groups_a_piece = 16;
    const std::size_t groups = (lane_cells + width - 1) / width;
    parallel_for((groups + groups_a_piece - 1) / groups_a_piece, threads, progress, [&](std::size_t piece) {
        const auto cells = std::make_unique<LaneCells>(raster, depth, planes, out);
        for (std::size_t g = piece * groups_a_piece; g < std::min((piece + 1) * groups_a_piece, groups); ++g)
            cells->measure(g * width, lane_cells);
    });
    if (lattice.width() > raster.width() || lattice.height() > raster.height())
        clear_padding(raster, levels - depth, out);
    if (raster.has_void())
        parallel_for(static_cast<std::size_t>(grid.root_count()), threads, [&](std::size_t i) {
            const CellCode root = grid.root(static_cast<int>(i));
            mark_mixed(raster, root, 0, lattice.root_corners(root), out);
        });
    return out;
}

}  // namespace planet
