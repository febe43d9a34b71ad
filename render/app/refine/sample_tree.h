#pragma once
// The samples of a raster in boxes in boxes: those near a triangle are found without a look at the others.

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace render {

struct SampleBox {
    glm::dvec3 low, high;
};

class SampleTree {
  public:
    /// Samples that lie side by side; both ends are included.
    struct Block {
        int left, right, low, high;  ///< columns and rows
    };

    SampleTree() = default;
    /// @param key where a sample is to be found
    SampleTree(int width, int height, const std::function<glm::dvec3(int column, int row)>& key);

    /// Calls visit(Block) for all blocks that may hold a sample in a box.
    template <class Visit>
    void visit(const SampleBox& box, Visit&& visit) const {
        if (!levels_.empty()) descend(levels_.size() - 1, 0, 0, box, visit);
    }

  private:
    static constexpr int block_size = 8;

    // Level 0 has a box for each block, the next one for each four of these.
    struct Level {
        int columns, rows;
        std::vector<SampleBox> boxes;
        const SampleBox& at(int column, int row) const {
            return boxes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                         static_cast<std::size_t>(column)];
        }
    };

    static SampleBox around_both(const SampleBox& a, const SampleBox& b) {
        return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
    }
    Block block(int column, int row) const;
    void add_blocks(const std::function<glm::dvec3(int column, int row)>& key);
    void add_level();

    template <class Visit>
    void descend(std::size_t level, int column, int row, const SampleBox& box, Visit&& visit) const {
        const SampleBox& own = levels_[level].at(column, row);
        if (glm::any(glm::lessThan(own.high, box.low)) || glm::any(glm::greaterThan(own.low, box.high))) return;
        if (level == 0) return visit(block(column, row));
        const Level& below = levels_[level - 1];
        for (int r = 2 * row; r < std::min(2 * row + 2, below.rows); ++r)
            for (int c = 2 * column; c < std::min(2 * column + 2, below.columns); ++c)
                descend(level - 1, c, r, box, visit);
    }

    int width_ = 0, height_ = 0;
    std::vector<Level> levels_;
};

}  // namespace render
