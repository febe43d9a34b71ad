#pragma once
// Which parts of a raster meet a cap: blocks of samples, each within a cap of its own, in a tree.

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "planet/elevation/elevation_field.h"

namespace planet {

class RasterBlocks {
  public:
    struct Block {
        glm::dvec3 centre{0, 0, 1};
        double angle = 0;                                          ///< every sample of the block is within; rad
        double spacing = std::numeric_limits<double>::infinity();  ///< m; infinity: nothing but voids
    };

    RasterBlocks() = default;
    /// @param blocks  row-major, columns * rows of them; 48 bytes are kept for each and a fifteenth of that more
    RasterBlocks(int columns, int rows, const std::vector<Block>& blocks);

    int columns() const { return levels_.empty() ? 0 : levels_[0].columns; }
    int rows() const { return levels_.empty() ? 0 : levels_[0].rows; }

    /// Calls visit(column, row, spacing) for every block that may meet the cap and holds samples closer than `wanted`.
    /// What visit returns is wanted of the next ones.
    template <class Visit>
    void visit(const Cap& cap, Visit visit) const {
        if (levels_.empty()) return;
        const Half half{std::sin(0.5 * cap.angle), std::cos(0.5 * cap.angle)};
        double wanted = std::numeric_limits<double>::infinity();
        descend(levels_.size() - 1, 0, 0, cap.centre, half, wanted, visit);
    }

  private:
    static constexpr int fan = 4;  // children a side

    // Of half an angle: tells whether two caps meet without an arcsine.
    struct Half {
        double sine, cosine;
    };
    struct Node {
        glm::dvec3 centre;
        Half half;
        double spacing;
    };
    struct Level {
        int columns = 0, rows = 0;
        std::vector<Node> nodes;
        const Node& at(int column, int row) const {
            return nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                         static_cast<std::size_t>(column)];
        }
    };

    static bool meet(const Node& node, const glm::dvec3& centre, const Half& half) {
        if (node.half.cosine * half.cosine <= node.half.sine * half.sine) return true;  // together half a turn or more
        const double reach = 2 * (node.half.sine * half.cosine + node.half.cosine * half.sine);
        const glm::dvec3 d = node.centre - centre;
        return glm::dot(d, d) <= reach * reach * (1 + 1e-12);
    }

    template <class Visit>
    void descend(std::size_t level, int column, int row, const glm::dvec3& centre, const Half& half, double& wanted,
                 Visit& visit) const {
        const Node& node = levels_[level].at(column, row);
        if (!(node.spacing < wanted) || !meet(node, centre, half)) return;
        if (level == 0) {
            wanted = visit(column, row, node.spacing);
            return;
        }
        const Level& below = levels_[level - 1];
        for (int j = row * fan; j < std::min((row + 1) * fan, below.rows); ++j)
            for (int i = column * fan; i < std::min((column + 1) * fan, below.columns); ++i)
                descend(level - 1, i, j, centre, half, wanted, visit);
    }

    Node node_of(const Block& block) const;
    Level above(const Level& level, std::vector<Block>& blocks) const;

    std::vector<Level> levels_;  // finest first
};

}  // namespace planet
