#pragma once
// The samples of a lattice triangle, row by row.

#include <algorithm>
#include <glm/glm.hpp>
#include <utility>

#include "planet/quadtree/patch_lattice.h"

namespace planet {

/// Samples first .. last of a row, both included.
struct RowSpan {
    int first, last;
};

/// Rows of a cell: its sides are upright, level or diagonal, so spans end on samples exactly.
class TriangleRows {
  public:
    explicit TriangleRows(const LatticeCorners& c) {
        glm::ivec2 low = c.left, middle = c.right, high = c.apex;
        if (low.y > middle.y) std::swap(low, middle);
        if (middle.y > high.y) std::swap(middle, high);
        if (low.y > middle.y) std::swap(low, middle);
        bottom_ = low.y;
        bend_ = middle.y;
        top_ = high.y;
        long_ = {low, slope(low, high)};
        if (low.y < middle.y)
            below_ = {low, slope(low, middle)};
        else
            below_ = {middle, 0};
        above_ = middle.y < high.y ? Side{middle, slope(middle, high)} : below_;
    }

    int bottom() const { return bottom_; }
    int top() const { return top_; }

    /// @param y from bottom() to top()
    RowSpan at(int y) const { return span(y, y <= bend_ ? below_ : above_); }
    /// The same seen from a little above the row, or below it: another span only where a side of the triangle is level.
    /// Empty at the top, or the bottom.
    RowSpan just_above(int y) const { return y == top_ ? RowSpan{0, -1} : span(y, y < bend_ ? below_ : above_); }
    RowSpan just_below(int y) const { return y == bottom_ ? RowSpan{0, -1} : span(y, y <= bend_ ? below_ : above_); }

  private:
    struct Side {
        glm::ivec2 start{0};
        int slope = 0;  ///< of x by y: -1, 0, 1
        int at(int y) const { return start.x + slope * (y - start.y); }
    };
    RowSpan span(int y, const Side& other) const {
        const int a = long_.at(y), b = other.at(y);
        return {std::min(a, b), std::max(a, b)};
    }
    static int slope(glm::ivec2 p, glm::ivec2 q) { return (q.x > p.x) - (q.x < p.x); }

    int bottom_, bend_, top_;
    Side long_, below_, above_;  ///< from the lowest corner to the highest, and by way of the third
};

}  // namespace planet
