#include "render/app/refine/sample_tree.h"

namespace render {

SampleTree::SampleTree(int width, int height, const std::function<glm::dvec3(int column, int row)>& key)
    : width_(width), height_(height) {
    add_blocks(key);
    while (levels_.back().boxes.size() > 1) add_level();
}

SampleTree::Block SampleTree::block(int column, int row) const {
    return {column * block_size, std::min((column + 1) * block_size, width_) - 1, row * block_size,
            std::min((row + 1) * block_size, height_) - 1};
}

void SampleTree::add_blocks(const std::function<glm::dvec3(int column, int row)>& key) {
    Level level{(width_ + block_size - 1) / block_size, (height_ + block_size - 1) / block_size, {}};
    for (int row = 0; row < level.rows; ++row)
        for (int column = 0; column < level.columns; ++column) {
            const Block b = block(column, row);
            const glm::dvec3 first = key(b.left, b.low);
            SampleBox box{first, first};
            for (int r = b.low; r <= b.high; ++r)
                for (int c = b.left; c <= b.right; ++c) {
                    const glm::dvec3 p = key(c, r);
                    box = around_both(box, {p, p});
                }
            level.boxes.push_back(box);
        }
    levels_.push_back(std::move(level));
}

void SampleTree::add_level() {
    const Level& below = levels_.back();
    Level level{(below.columns + 1) / 2, (below.rows + 1) / 2, {}};
    for (int row = 0; row < level.rows; ++row)
        for (int column = 0; column < level.columns; ++column) {
            SampleBox box = below.at(2 * column, 2 * row);
            for (int r = 2 * row; r < std::min(2 * row + 2, below.rows); ++r)
                for (int c = 2 * column; c < std::min(2 * column + 2, below.columns); ++c)
                    box = around_both(box, below.at(c, r));
            level.boxes.push_back(std::move(box));
        }
    levels_.push_back(std::move(level));
}

}  // namespace render
