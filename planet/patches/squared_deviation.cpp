#include "planet/patches/squared_deviation.h"

#include <algorithm>
#include <cmath>

#include "planet/parallel.h"

namespace planet {

namespace {

// Sums over the samples of a cell: of squared residuals, of residual times coordinate, of products of coordinates.
struct Moments {
    double squares = 0;
    double left = 0, right = 0, apex = 0;
    double left_left = 0, right_right = 0, apex_apex = 0, left_right = 0, left_apex = 0, right_apex = 0;
    bool has_void = false;

    Moments mirrored() const {
        return {squares,   right,      left,       apex,      right_right, left_left,
                apex_apex, left_right, right_apex, left_apex, has_void};
    }
    Moments& operator+=(const Moments& o) {
        squares += o.squares;
        left += o.left, right += o.right, apex += o.apex;
        left_left += o.left_left, right_right += o.right_right, apex_apex += o.apex_apex;
        left_right += o.left_right, left_apex += o.left_apex, right_apex += o.right_apex;
        has_void |= o.has_void;
        return *this;
    }
};

// Child 0's sums in its parent's coordinates (l + a/2, a/2, r), against the parent's plane.
// @param rise of the split vertex above the parent's plane
Moments in_parent(const Moments& c, double rise) {
    const double left = c.left + rise * c.left_apex, right = c.right + rise * c.right_apex,
                 apex = c.apex + rise * c.apex_apex;
    Moments p;
    p.squares = c.squares + rise * (2 * c.apex + rise * c.apex_apex);
    p.left = left + apex / 2;
    p.right = apex / 2;
    p.apex = right;
    p.left_left = c.left_left + c.left_apex + c.apex_apex / 4;
    p.right_right = c.apex_apex / 4;
    p.apex_apex = c.right_right;
    p.left_right = c.left_apex / 2 + c.apex_apex / 4;
    p.left_apex = c.left_right + c.right_apex / 2;
    p.right_apex = c.right_apex / 2;
    p.has_void = c.has_void;
    return p;
}

struct CornerHeights {
    double left, right, apex;
};

class MomentWalk {
  public:
    MomentWalk(const PatchRaster& raster, DenseQuadtree<double>& out)
        : raster_(raster), out_(out), last_(raster.width() - 1, raster.height() - 1) {}

    /// The cells of a level, for a later walk to begin with instead of going below it.
    void run_pieces(int level, unsigned threads) {
        const PatchLattice& lattice = raster_.lattice();
        const CellCode base = CellCode{1} << (raster_.grid().root_bits() + level);
        std::vector<Moments> pieces(static_cast<std::size_t>(raster_.grid().root_count()) << level);
        parallel_for(pieces.size(), threads,
                     [&](std::size_t i) { pieces[i] = cell(base + i, level, lattice.corners(base + i)); });
        pieces_ = std::move(pieces);
        piece_level_ = level;
    }
    void run_roots() {
        for (int rank = 0; rank < raster_.grid().root_count(); ++rank)
            cell(raster_.grid().root(rank), 0, raster_.lattice().root_corners(raster_.grid().root(rank)));
    }

  private:
    Moments cell(CellCode code, int level, const LatticeCorners& c) {
        return cell(code, level, c, {height(c.left), height(c.right), height(c.apex)});
    }

    Moments cell(CellCode code, int level, const LatticeCorners& c, const CornerHeights& h) {
        if (raster_.outside(c)) return {};
        if (level == out_.levels()) return unit_cell(c, h);
        if (level == piece_level_) return pieces_[code - (CellCode{1} << (raster_.grid().root_bits() + level))];
        const double middle = height(PatchLattice::split_vertex(c));
        const double rise = middle - (h.left + h.right) / 2;
        const Moments first = cell(code << 1, level + 1, PatchLattice::child(c, 0), {h.left, h.apex, middle});
        const Moments second = cell(code << 1 | 1, level + 1, PatchLattice::child(c, 1), {h.apex, h.right, middle});
        Moments sums;
        if (first.has_void || second.has_void || std::isnan(rise)) {
            sums.has_void = true;  // mixed, or wholly void: no plane
        } else {
            sums = in_parent(first, rise);
            sums += in_parent(second.mirrored(), rise).mirrored();
        }
        out_[code] = std::max(0.0, sums.squares);
        return sums;
    }

    Moments unit_cell(const LatticeCorners& c, const CornerHeights& h) const {
        Moments sums;
        sums.left_left = weight(c.left) / 8;
        sums.right_right = weight(c.right) / 8;
        sums.apex_apex = weight(c.apex) / 4;
        sums.has_void = std::isnan(h.left + h.right + h.apex);
        return sums;
    }
    // Of the angle around a sample, 1 / weight lies within the raster.
    double weight(glm::ivec2 p) const {
        return (p.x == 0 || p.x == last_.x ? 2 : 1) * (p.y == 0 || p.y == last_.y ? 2 : 1);
    }
    double height(glm::ivec2 p) const { return static_cast<double>(raster_.at(p)); }

    const PatchRaster& raster_;
    DenseQuadtree<double>& out_;
    const glm::ivec2 last_;
    std::vector<Moments> pieces_;
    int piece_level_ = -1;
};

}  // namespace

DenseQuadtree<double> patch_squared_deviations(const PatchRaster& raster, unsigned threads) {
    const PatchGrid& grid = raster.grid();
    const int levels = raster.lattice().bisection_levels();
    DenseQuadtree<double> out(grid.root_bits(), grid.root_count(), levels);
    for (int level = 0; level < levels; ++level) std::ranges::fill(out.level(level), 0.0);
    MomentWalk walk(raster, out);
    if (levels > 0) walk.run_pieces(std::min(levels - 1, 6), threads);
    walk.run_roots();
    return out;
}

double squared_deviation(const PatchTriangulation& mesh, const DenseQuadtree<double>& squared) {
    double sum = 0;
    mesh.for_each_leaf([&](CellCode leaf) {
        const int level = mesh.level_of(leaf);
        if (level < squared.levels()) sum += squared.at(leaf, level);
    });
    return sum;
}

}  // namespace planet
