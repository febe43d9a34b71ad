#pragma once
// The merging domain of a vertex in a mesh that stays as it is: what Triangulation::remove would merge, for a cost.

#include <vector>

#include "planet/quadtree/triangulation.h"

namespace planet {

/// Keeps its storage, a bit a cell, from one use to the next.
template <Topology Topo, class SplitSet>
class MergingDomain {
  public:
    explicit MergingDomain(const Triangulation<Topo, SplitSet>& mesh)
        : mesh_(mesh), merged_(mesh.topology().root_bits(), mesh.levels()) {}

    /// Visits the maximal merged triangles in the order of Triangulation::remove, and nothing below them.
    /// @param cell a split one @param on_merged (cell, its bisection level)
    template <class OnMerged>
    void visit(CellCode cell, OnMerged&& on_merged) {
        const int first_level = mesh_.level_of(cell);
        cells_.assign(1, cell);
        if (const CellCode n = mesh_.topology().neighbor(cell); n != 0) cells_.push_back(n);
        std::size_t begin = 0;
        for (int level = first_level; begin < cells_.size(); ++level) {
            const std::size_t end = cells_.size();
            for (std::size_t i = begin; i < end; ++i) on_merged(cells_[i], level);
            if (level + 1 == mesh_.levels()) break;
            // Where remove() drops cells, these are marked: a cell is gone if it is below a marked one.
            for (std::size_t i = begin; i < end; ++i) merged_.insert(cells_[i]);
            for (std::size_t i = begin; i < end; ++i)
                for (const CellCode child : {cells_[i] << 1, cells_[i] << 1 | 1}) {
                    if (!mesh_.is_split(child)) continue;
                    const CellCode across = mesh_.topology().neighbor(child);
                    if (across != 0 && mesh_.is_split(across) && !is_merged(across, level + 1 - first_level))
                        cells_.push_back(across);
                }
            begin = end;
        }
        for (const CellCode c : cells_) merged_.drop(c);
    }

  private:
    bool is_merged(CellCode cell, int levels_above) const {
        for (int k = 1; k <= levels_above; ++k)
            if (merged_.contains(cell >> k)) return true;
        return false;
    }

    const Triangulation<Topo, SplitSet>& mesh_;
    SplitSet merged_;  ///< empty between uses
    std::vector<CellCode> cells_;
};

}  // namespace planet
