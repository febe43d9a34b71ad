#pragma once
// Closure, both ways. A conforming triangulation of any topology as the set of its split cells; splitting and removing
// keep it conforming.
//
//   refining     splitting a diamond needs its two parent diamonds split first
//   coarsening   removing a vertex removes every vertex that depends on it: its *merging domain*. After Balmelli,
//                Kovacevic and Vetterli, "Solving the Coplanarity Problem of Regular Embedded Triangulations"
//
// The domain grows in spreading steps. Step 1 merges the two cells of the vertex; step s + 1 those cells, one level
// finer, that lie across a leg from a cell of step s and are split along it:
//
//        . _______ .          c merges: its children go, and with them the split vertices of its legs,
//        |\   n   /|          so the cells n, n' across the legs, if they are split there, merge in the next step.
//        |  \   /  |
//        | c  X  n'|          All cells of a step are dropped before the next step is looked for; what lies below a
//        |  /   \  |          merged cell is dropped with it, as a range, and never walked. So every cell visited is a
//        |/_______\|          *maximal merged* triangle and is visited once: the work is the size of the answer.

#include <optional>
#include <vector>

#include "planet/quadtree/split_set.h"
#include "planet/quadtree/topology.h"

namespace planet {

template <Topology Topo, class SplitSet>
class Triangulation {
  public:
    /// The roots only. @param levels cells of bisection levels 0 .. levels - 1 can be split
    Triangulation(Topo topology, int levels) : topology_(topology), split_(topology.root_bits(), levels) {}

    const Topo& topology() const { return topology_; }
    int levels() const { return split_.levels(); }
    const SplitSet& split_cells() const { return split_; }
    /// For those who set many cells at once; check() tells whether the result is conforming.
    SplitSet& split_cells() { return split_; }

    int level_of(CellCode cell) const { return bisection_level_of(cell, topology_.root_bits()); }
    bool is_split(CellCode cell) const { return split_.contains(cell); }
    bool is_leaf(CellCode cell) const { return exists(cell) && !is_split(cell); }
    /// In the triangulation, as a leaf or above leaves.
    bool exists(CellCode cell) const { return is_root(cell) || is_split(cell >> 1); }

    /// Splits a diamond, after those that it depends on. @param cell either of its cells, of a level below levels()
    /// @param on_split called for each diamond that is split, parents first: (cell, neighbor or 0)
    /// @return how many were split; 0 if it was split already
    template <class OnSplit>
    int split(CellCode cell, OnSplit&& on_split) {
        const Insertion inserted = split_.insert(cell);
        if (!inserted.is_new) return 0;
        const CellCode n = topology_.neighbor(cell);
        const bool other_parent_split = n == 0 || split_.insert(n).parent_split;
        int count = 1;
        if (!is_root(cell)) {
            if (!inserted.parent_split) count += split(cell >> 1, on_split);
            if (!other_parent_split) count += split(n >> 1, on_split);
        }
        on_split(cell, n);
        return count;
    }
    int split(CellCode cell) {
        return split(cell, [](CellCode, CellCode) {});
    }

    /// The inverse of one split. @return false, and nothing happens, if the diamond is not split or another vertex
    /// depends on it
    bool merge(CellCode cell) {
        const CellCode n = topology_.neighbor(cell);
        if (!is_split(cell) || has_split_child(cell) || (n != 0 && has_split_child(n))) return false;
        split_.drop(cell);
        if (n != 0) split_.drop(n);
        return true;
    }

    /// Removes the split vertex of a diamond with its merging domain. @param on_merge called for every merged triangle
    /// before it merges: (cell, spreading step from 1) @return how many cells were visited: the merged triangles. 0 if the diamond
    /// is not split
    template <class OnMerge>
    std::size_t remove(CellCode cell, OnMerge&& on_merge) {
        if (!is_split(cell)) return 0;
        frontier_.assign(1, cell);
        if (const CellCode n = topology_.neighbor(cell); n != 0) frontier_.push_back(n);
        std::size_t visited = 0;
        for (int step = 1; !frontier_.empty(); ++step) {
            visited += frontier_.size();
            merge_frontier(step, on_merge);
            cross_to_next_frontier();
        }
        return visited;
    }
    std::size_t remove(CellCode cell) {
        return remove(cell, [](CellCode, int) {});
    }

    /// Visits the leaves in the order of the curve.
    template <class OnLeaf>
    void for_each_leaf(OnLeaf&& on_leaf) const {
        for (int rank = 0; rank < topology_.root_count(); ++rank) leaves_below(topology_.root(rank), on_leaf);
    }

    /// Visits every split cell below and including `cell`, in pre-order.
    template <class OnCell>
    void for_each_split_below(CellCode cell, OnCell&& on_cell) const {
        if (!is_split(cell)) return;
        on_cell(cell);
        for_each_split_below(cell << 1, on_cell);
        for_each_split_below(cell << 1 | 1, on_cell);
    }

    /// A split cell whose diamond is not whole, or whose parent is not split; std::nullopt if the triangulation is
    /// conforming. Looks at what the roots lead to.
    std::optional<CellCode> check() const {
        std::optional<CellCode> wrong;
        for (int rank = 0; rank < topology_.root_count(); ++rank)
            for_each_split_below(topology_.root(rank), [&](CellCode c) {
                const CellCode n = topology_.neighbor(c);
                if (n != 0 && (!is_split(n) || !exists(n))) wrong = c;
            });
        return wrong;
    }

  private:
    bool is_root(CellCode cell) const { return cell >> topology_.root_bits() == 1; }
    bool has_split_child(CellCode cell) const { return is_split(cell << 1) || is_split(cell << 1 | 1); }

    // Both write every candidate and step past those that count: which ones do is anybody's guess, a processor's too.
    template <class OnMerge>
    void merge_frontier(int step, OnMerge& on_merge) {
        opened_.resize(2 * frontier_.size());
        CellCode* end = opened_.data();
        for (const CellCode c : frontier_) {
            on_merge(c, step);
            const unsigned children = split_.drop(c);
            *end = c << 1;
            end += children & 1;
            *end = c << 1 | 1;
            end += children >> 1;
        }
        opened_.resize(static_cast<std::size_t>(end - opened_.data()));
    }
    void cross_to_next_frontier() {
        frontier_.resize(opened_.size());
        CellCode* end = frontier_.data();
        for (const CellCode child : opened_) {
            *end = topology_.neighbor(child);
            end += is_split(*end);
        }
        frontier_.resize(static_cast<std::size_t>(end - frontier_.data()));
    }

    template <class OnLeaf>
    void leaves_below(CellCode cell, OnLeaf&& on_leaf) const {
        if (is_split(cell)) {
            leaves_below(cell << 1, on_leaf);
            leaves_below(cell << 1 | 1, on_leaf);
        } else {
            on_leaf(cell);
        }
    }

    Topo topology_;
    SplitSet split_;
    std::vector<CellCode> frontier_, opened_;  ///< of remove(), kept for their storage
};

}  // namespace planet
