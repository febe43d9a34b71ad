#include "planet/elevation/raster_blocks.h"

#include <algorithm>
#include <numbers>

namespace planet {
namespace {

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return 2 * std::asin(std::min(1.0, 0.5 * glm::distance(a, b)));
}

// The cap of several, around the mean of their centres.
RasterBlocks::Block join(const std::vector<RasterBlocks::Block>& parts) {
    RasterBlocks::Block joined;
    glm::dvec3 sum(0);
    for (const auto& p : parts) sum += p.centre;
    joined.centre = glm::length(sum) > 1e-6 ? glm::normalize(sum) : parts.front().centre;
    for (const auto& p : parts) {
        joined.angle = std::max(joined.angle, angle_between(p.centre, joined.centre) + p.angle);
        joined.spacing = std::min(joined.spacing, p.spacing);
    }
    return joined;
}

}  // namespace

RasterBlocks::RasterBlocks(int columns, int rows, const std::vector<Block>& blocks) {
    std::vector<Block> current = blocks;
    levels_.push_back({columns, rows, {}});
    for (const Block& b : current) levels_.back().nodes.push_back(node_of(b));
    while (levels_.back().nodes.size() > 1) levels_.push_back(above(levels_.back(), current));
}

RasterBlocks::Node RasterBlocks::node_of(const Block& block) const {
    const double half = 0.5 * std::min(block.angle, std::numbers::pi);
    return {block.centre, {std::sin(half), std::cos(half)}, block.spacing};
}

RasterBlocks::Level RasterBlocks::above(const Level& level, std::vector<Block>& blocks) const {
    Level joined{(level.columns + fan - 1) / fan, (level.rows + fan - 1) / fan, {}};
    std::vector<Block> parts, next;
    for (int row = 0; row < joined.rows; ++row)
        for (int column = 0; column < joined.columns; ++column) {
            parts.clear();
            for (int j = row * fan; j < std::min((row + 1) * fan, level.rows); ++j)
                for (int i = column * fan; i < std::min((column + 1) * fan, level.columns); ++i) {
                    const Block& b = blocks[static_cast<std::size_t>(j) * static_cast<std::size_t>(level.columns) +
                                            static_cast<std::size_t>(i)];
                    if (!std::isinf(b.spacing)) parts.push_back(b);
                }
            next.push_back(parts.empty() ? Block{} : join(parts));
            joined.nodes.push_back(node_of(next.back()));
        }
    blocks = std::move(next);
    return joined;
}

}  // namespace planet
