#include "planet/patches/patch_deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "planet/parallel.h"
#include "planet/patches/triangle_rows.h"

namespace planet {

namespace {

constexpr std::size_t width = 8;
typedef double Lanes __attribute__((vector_size(width * sizeof(double))));

constexpr int lane_depth = 8;
constexpr std::size_t lane_vertices = 153;  // (16 + 1)(16 + 2) / 2

inline Lanes absolute(Lanes v) {
    return v < 0 ? -v : v;
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

// ---- large cells: rows ----

struct Plane {
    double height, per_x, per_y;  // at the corner `at`
    glm::ivec2 at;
};

Plane plane_through(const PatchRaster& raster, const LatticeCorners& c) {
    const double a = static_cast<double>(raster.at(c.left)), b = static_cast<double>(raster.at(c.right)),
                 h = static_cast<double>(raster.at(c.apex));
    const glm::dvec2 u(c.right - c.left), v(c.apex - c.left);
    const double area = u.x * v.y - u.y * v.x;  // a power of two: exact
    return {a, ((b - a) * v.y - (h - a) * u.y) / area, ((h - a) * u.x - (b - a) * v.x) / area, c.left};
}

// Heights of a row, eight from `x` on; what lies beyond the row's end is read too (PatchRaster keeps it readable).
Lanes load(const float* heights) {
    typedef float Floats __attribute__((vector_size(width * sizeof(float))));
    Floats f;
    std::memcpy(&f, heights, sizeof f);
    return __builtin_convertvector(f, Lanes);
}

// worst = max(worst, |plane - height|) lane by lane; NaN, a void sample, leaves it as it is.
void widen_by_row(Lanes& worst, const float* heights, int count, double start, double per_x) {
    constexpr Lanes ramp{0, 1, 2, 3, 4, 5, 6, 7};
    Lanes x = ramp;
    for (; count >= static_cast<int>(width); count -= static_cast<int>(width), heights += width) {
        const Lanes t = absolute(start + per_x * x - load(heights));
        worst = t > worst ? t : worst;
        x += static_cast<double>(width);
    }
    if (count > 0) {
        const Lanes t = absolute(start + per_x * x - load(heights));
        worst = (t > worst) & (ramp < static_cast<double>(count)) ? t : worst;
    }
}

double worst_in_cell(const PatchRaster& raster, const LatticeCorners& c) {
    if (raster.outside(c)) return 0;
    const TriangleRows rows(c);
    const Plane plane = plane_through(raster, c);
    Lanes worst{};
    for (int y = rows.bottom(); y <= std::min(rows.top(), raster.height() - 1); ++y) {
        const RowSpan span = rows.at(y);
        const int count = std::min(span.last, raster.width() - 1) - span.first + 1;
        const double start = plane.height + plane.per_y * (y - plane.at.y) + plane.per_x * (span.first - plane.at.x);
        if (count > 0) widen_by_row(worst, raster.row(y) + span.first, count, start, plane.per_x);
    }
    double largest = 0;
    for (std::size_t w = 0; w < width; ++w) largest = std::max(largest, worst[w]);
    return largest;
}

// ---- small cells: lanes ----

// Barycentric coordinates of a vertex in a cell, in `whole`ths.
struct Barycentric {
    int left, right, apex;
    friend bool operator==(const Barycentric&, const Barycentric&) = default;
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

// Eight cells of one level, and all below them.
class LaneCells {
  public:
    LaneCells(const PatchRaster& raster, int depth, DenseQuadtree<float>& out)
        : raster_(raster), depth_(depth), level_(raster.lattice().bisection_levels() - depth), out_(out) {}

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
        } else if (clipped) {
            cell<true>(depth_, 0, 0, worst);
        } else {
            cell<false>(depth_, 0, 0, worst);
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
        Lanes plane{}, plane_right{}, plane_apex{};
        for (std::size_t w = 0; w < width; ++w) {
            const LatticeCorners& c = corners_[w];
            const glm::ivec2 right = (c.right - c.left) / whole_of_cell(), apex = (c.apex - c.left) / whole_of_cell();
            index[w] = c.left.y * raster_.width() + c.left.x;
            index_right[w] = right.y * raster_.width() + right.x;
            index_apex[w] = apex.y * raster_.width() + apex.x;
            plane[w] = static_cast<double>(raster_.at(c.left));
            plane_right[w] = (static_cast<double>(raster_.at(c.right)) - plane[w]) / whole_of_cell();
            plane_apex[w] = (static_cast<double>(raster_.at(c.apex)) - plane[w]) / whole_of_cell();
        }
        has_void_ = any(plane != plane) || any(plane_right != plane_right) || any(plane_apex != plane_apex);
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
            residual[v] = height - (plane + plane_right * right + plane_apex * apex);
            worst = larger(worst, clipped ? residual[v] * counts[v] : residual[v]);
        }
        return worst;
    }

    // A void split vertex would leave its descendants without residuals.
    void by_rows(int level) {
        const auto cells = out_.level(level_ + level);
        const CellCode base = CellCode{1} << (raster_.grid().root_bits() + level_ + level);
        for (std::size_t i = first_ << level; i < (first_ + lanes_) << level; ++i)
            cells[i] = rounded_up(worst_in_cell(raster_, raster_.lattice().corners(base + i)));
    }

    static Lanes larger(Lanes worst, Lanes residual) {
        const Lanes t = absolute(residual);
        return t > worst ? t : worst;
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
    DenseQuadtree<float>& out_;
    std::size_t first_ = 0, lanes_ = 0;
    bool has_void_ = false;
    std::array<LatticeCorners, width> corners_{};
    std::array<std::array<Lanes, lane_vertices>, lane_depth + 1> residual_, counts_;
};

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

DenseQuadtree<float> patch_deviations(const PatchRaster& raster, unsigned threads) {
    const PatchLattice& lattice = raster.lattice();
    const PatchGrid& grid = raster.grid();
    const int levels = lattice.bisection_levels();
    DenseQuadtree<float> out(grid.root_bits(), grid.root_count(), levels);
    const int depth = std::min(lane_depth, levels);
    if (depth == 0) return out;

    const std::size_t lane_cells = static_cast<std::size_t>(grid.root_count()) << (levels - depth);
    constexpr std::size_t groups_a_piece = 16;
    const std::size_t groups = (lane_cells + width - 1) / width;
    parallel_for((groups + groups_a_piece - 1) / groups_a_piece, threads, [&](std::size_t piece) {
        const auto cells = std::make_unique<LaneCells>(raster, depth, out);
        for (std::size_t g = piece * groups_a_piece; g < std::min((piece + 1) * groups_a_piece, groups); ++g)
            cells->measure(g * width, lane_cells);
    });
    for (int level = levels - depth - 1; level >= 0; --level) {
        const auto cells = out.level(level);
        const CellCode base = CellCode{1} << (grid.root_bits() + level);
        const std::size_t cells_a_piece = std::max(std::size_t{1}, cells.size() / 256);
        parallel_for((cells.size() + cells_a_piece - 1) / cells_a_piece, threads, [&](std::size_t piece) {
            for (std::size_t i = piece * cells_a_piece; i < std::min((piece + 1) * cells_a_piece, cells.size()); ++i)
                cells[i] = rounded_up(worst_in_cell(raster, lattice.corners(base + i)));
        });
    }
    if (raster.has_void())
        parallel_for(static_cast<std::size_t>(grid.root_count()), threads, [&](std::size_t i) {
            const CellCode root = grid.root(static_cast<int>(i));
            mark_mixed(raster, root, 0, lattice.root_corners(root), out);
        });
    return out;
}

}  // namespace planet
