#include "planet/patches/decimation.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/patches/candidate_queue.h"
#include "planet/quadtree/merging_domain.h"

namespace planet {

namespace {

constexpr float never = std::numeric_limits<float>::infinity();

void saturate(const PatchGrid& grid, DenseQuadtree<float>& cost) {
    for (int level = cost.levels() - 1; level >= 0; --level) {
        const auto cells = cost.level(level);
        const CellCode base = CellCode{1} << (grid.root_bits() + level);
        if (level + 1 < cost.levels()) {
            const auto below = cost.level(level + 1);
            for (std::size_t i = 0; i < cells.size(); ++i)
                cells[i] = std::max({cells[i], below[2 * i], below[2 * i + 1]});
        }
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const CellCode n = grid.neighbor(base + i);
            if (n > base + i) cells[i] = cells[n - base] = std::max(cells[i], cells[n - base]);
        }
    }
}

DenseQuadtree<float> copy(const PatchGrid& grid, const DenseQuadtree<float>& from) {
    DenseQuadtree<float> to(grid.root_bits(), grid.root_count(), from.levels());
    for (int level = 0; level < from.levels(); ++level) std::ranges::copy(from.level(level), to.level(level).begin());
    return to;
}

std::vector<CellCode> kept_cells(const PatchTriangulation& mesh, const PatchLattice& lattice,
                                 std::span<const glm::ivec2> samples) {
    std::vector<CellCode> cells;
    for (const glm::ivec2 sample : samples)
        if (const auto cell = lattice.cell_split_at(sample); cell && mesh.is_split(*cell)) cells.push_back(*cell);
    return cells;
}

// Saturated deviations; infinite where a diamond must stay.
DenseQuadtree<float> saturated_with_kept(const PatchGrid& grid, const DenseQuadtree<float>& deviation,
                                         std::span<const CellCode> kept) {
    DenseQuadtree<float> cost = copy(grid, deviation);
    for (const CellCode cell : kept) cost[cell] = never;
    saturate(grid, cost);
    return cost;
}

class TriangleCount {
  public:
    explicit TriangleCount(const PatchRaster& raster)
        : raster_(raster),
          whole_(!raster.has_void() && raster.lattice().width() == raster.width() &&
                 raster.lattice().height() == raster.height()) {}

    std::size_t of_leaf(const LatticeCorners& c) const { return whole_ ? 1 : triangles_of_leaf(raster_, c); }
    std::size_t of_mesh(const PatchTriangulation& mesh) const {
        std::size_t n = 0;
        for (int rank = 0; rank < mesh.topology().root_count(); ++rank) {
            const CellCode root = mesh.topology().root(rank);
            n += below(mesh, root, 0, raster_.lattice().root_corners(root));
        }
        return n;
    }
    // How many fewer there are once a cell with two leaves is one.
    std::size_t saved_by_merging(CellCode cell) const {
        if (whole_) return 1;
        const LatticeCorners c = raster_.lattice().corners(cell);
        return of_leaf(PatchLattice::child(c, 0)) + of_leaf(PatchLattice::child(c, 1)) - of_leaf(c);
    }

  private:
    std::size_t below(const PatchTriangulation& mesh, CellCode cell, int level, const LatticeCorners& c) const {
        if (level == mesh.levels() || !mesh.is_split(cell)) return of_leaf(c);
        if (raster_.outside(c)) return 0;
        return below(mesh, cell << 1, level + 1, PatchLattice::child(c, 0)) +
               below(mesh, cell << 1 | 1, level + 1, PatchLattice::child(c, 1));
    }

    const PatchRaster& raster_;
    const bool whole_;  ///< no voids, no padding
};

// ---- what weighs nothing ----

// The cells of a mesh that are split in it, at no cost of removal, but only lie in padding or voids: without those.
class WeightlessRemoval {
  public:
    WeightlessRemoval(const PatchTriangulation& mesh, const PatchRaster& raster, const DenseQuadtree<float>& saturated)
        : mesh_(mesh), raster_(raster), saturated_(saturated), needed_(coarsest(raster)) {}

    PatchTriangulation run() {
        for (int rank = 0; rank < mesh_.topology().root_count(); ++rank) {
            const CellCode root = mesh_.topology().root(rank);
            below(root, 0, raster_.lattice().root_corners(root));
        }
        return std::move(needed_);
    }

  private:
    void below(CellCode cell, int level, const LatticeCorners& c) {
        if (level == mesh_.levels() || !mesh_.is_split(cell)) return;
        if (saturated_.at(cell, level) == 0 && (raster_.outside(c) || std::isnan(raster_.at(c.left)))) return;
        needed_.split(cell);
        for (unsigned i = 0; i < 2; ++i) below(cell << 1 | i, level + 1, PatchLattice::child(c, i));
    }

    const PatchTriangulation& mesh_;
    const PatchRaster& raster_;
    const DenseQuadtree<float>& saturated_;
    PatchTriangulation needed_;
};

void tell(const DecimationOptions& options, const DecimationReport& report) {
    constexpr std::size_t removals_between = 1 << 14;
    if (!options.progress || report.removals % removals_between != 0) return;
    const double all = static_cast<double>(report.triangles_before) - static_cast<double>(options.max_triangles);
    options.progress(static_cast<double>(report.triangles_before - report.triangles) / std::max(all, 1.0));
}

// ---- max: one vertex after the other, for none depends on one that is as cheap ----

void decimate_by_largest(PatchTriangulation& mesh, const TriangleCount& count, const DenseQuadtree<float>& cost,
                         const DecimationOptions& options, DecimationReport& report) {
    std::vector<Candidate> order;
    for (int rank = 0; rank < mesh.topology().root_count(); ++rank)
        mesh.for_each_split_below(mesh.topology().root(rank), [&](CellCode cell) {
            const float c = cost[cell];
            if (c < never && static_cast<double>(c) <= options.max_cost && diamond(mesh.topology(), cell) == cell)
                order.push_back({c, cell});
        });
    std::sort(order.begin(), order.end());
    for (const Candidate& next : order) {
        if (report.triangles <= options.max_triangles) break;
        const CellCode n = mesh.topology().neighbor(next.cell);
        report.triangles -= count.saved_by_merging(next.cell) + (n != 0 ? count.saved_by_merging(n) : 0);
        [[maybe_unused]] const bool merged = mesh.merge(next.cell);
        assert(merged);
        ++report.removals;
        report.highest_cost = static_cast<double>(next.cost);
        tell(options, report);
    }
}

// ---- rms ----

// A change of the mesh.
struct Change {
    double squares = 0;          ///< m^2 added
    std::int64_t triangles = 0;  ///< removed
    double cost() const {
        if (triangles > 0) return squares / static_cast<double>(triangles);
        return squares > 0 ? static_cast<double>(never) : -static_cast<double>(never);
    }
};

// A split cell.
struct Cell {
    double squares;           ///< m^2 added if it is merged
    std::uint32_t triangles;  ///< saved if it is merged
    float cost;               ///< of its diamond as last worked out, `never` if it stays; in the cell that names it
};

class RmsDecimation {
  public:
    RmsDecimation(PatchTriangulation& mesh, const PatchRaster& raster, const TriangleCount& count,
                  const DenseQuadtree<float>& saturated)
        : mesh_(mesh),
          raster_(raster),
          count_(count),
          cells_(grid().root_bits(), grid().root_count(), mesh.levels()),
          domain_(mesh) {
        const DenseQuadtree<double> squared = patch_squared_deviations(raster);
        for (int level = 0; level < cells_.levels(); ++level) {
            const auto cells = cells_.level(level);
            const auto squares = squared.level(level);
            const auto costs = saturated.level(level);
            for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = {squares[i], 0, costs[i]};
        }
    }

    void run(const DecimationOptions& options, DecimationReport& report) {
        for (int rank = 0; rank < grid().root_count(); ++rank) {
            const CellCode root = grid().root(rank);
            squared_ += differences(root, 0, raster_.lattice().root_corners(root)).squares;
        }
        fill_queue();
        while (report.triangles > options.max_triangles)
            if (remove_cheapest(options.max_cost, report))
                tell(options, report);
            else
                break;
        report.costed_domains = costed_;
        report.rms_m = std::sqrt(std::max(0.0, squared_) / static_cast<double>(raster_.valid_samples()));
    }

  private:
    const PatchGrid& grid() const { return mesh_.topology(); }

    // What a cell is now. Replaces the squared deviations of split cells by what merging them would add.
    Change differences(CellCode cell, int level, const LatticeCorners& c) {
        if (level == mesh_.levels() || raster_.outside(c) || !mesh_.is_split(cell)) {
            const double squares = level == mesh_.levels() ? 0 : cells_.at(cell, level).squares;
            return {squares, static_cast<std::int64_t>(count_.of_leaf(c))};
        }
        const Change first = differences(cell << 1, level + 1, PatchLattice::child(c, 0)),
                     second = differences(cell << 1 | 1, level + 1, PatchLattice::child(c, 1));
        const Change now{first.squares + second.squares, first.triangles + second.triangles};
        cells_[cell].squares -= now.squares;
        cells_[cell].triangles =
            static_cast<std::uint32_t>(now.triangles) - static_cast<std::uint32_t>(count_.of_leaf(c));
        return now;
    }

    // Of removing a vertex with its merging domain in the present mesh.
    Change domain(CellCode cell) {
        ++costed_;
        Change change;
        domain_.visit(cell, [&](CellCode c, int level) {
            const Cell& merged = cells_.at(c, level);
            change.squares += merged.squares;
            change.triangles += merged.triangles;
        });
        return change;
    }

    void set_cost(CellCode cell, float cost) {
        cells_[cell].cost = cost;
        if (cost < never) queue_.push({cost, cell});
    }

    void fill_queue() {
        std::vector<Candidate> all;
        for (int rank = 0; rank < grid().root_count(); ++rank)
            mesh_.for_each_split_below(grid().root(rank), [&](CellCode cell) {
                if (diamond(grid(), cell) != cell || cells_[cell].cost == never) return;
                cells_[cell].cost = static_cast<float>(domain(cell).cost());
                if (cells_[cell].cost < never) all.push_back({cells_[cell].cost, cell});
            });
        queue_ = CandidateQueue(std::move(all));
    }

    // false: nothing is left that may go.
    bool remove_cheapest(double max_cost, DecimationReport& report) {
        while (!queue_.empty()) {
            const Candidate next = queue_.top();
            queue_.pop();
            if (!mesh_.is_split(next.cell) || cells_[next.cell].cost != next.cost) continue;  // superseded
            const Change change = domain(next.cell);
            const Candidate now{static_cast<float>(change.cost()), next.cell};
            if (!queue_.empty() && queue_.top() < now) {
                set_cost(now.cell, now.cost);
                continue;
            }
            if (change.cost() > max_cost) return false;
            remove(next.cell);
            squared_ += change.squares;
            report.triangles -= static_cast<std::size_t>(change.triangles);
            report.highest_cost = std::max(report.highest_cost, change.cost());
            ++report.removals;
            return true;
        }
        return false;
    }

    void remove(CellCode cell) {
        pending_.clear();
        mesh_.remove(cell, [&](CellCode merged, int step) {
            Cell& gone = cells_[merged];
            for (CellCode above = merged >> 1; above >> grid().root_bits() != 0; above >>= 1) {
                Cell& cell_above = cells_[above];
                cell_above.squares -= gone.squares;
                cell_above.triangles -= gone.triangles;
            }
            gone.squares = 0;
            gone.triangles = 0;
            if (step > 1) pending_.push_back(merged >> 1);
        });
        while (!pending_.empty()) {
            const CellCode above = diamond(grid(), pending_.back());
            pending_.pop_back();
            lower(above);
        }
    }

    // Where the cost has fallen, so may have the costs of its parents.
    void lower(CellCode cell) {
        const float known = cells_[cell].cost;
        if (!mesh_.is_split(cell) || known == never) return;
        const auto cost = static_cast<float>(domain(cell).cost());
        if (!(cost < known)) return;
        set_cost(cell, cost);
        if (cell >> grid().root_bits() == 1) return;
        pending_.push_back(cell >> 1);
        if (const CellCode n = grid().neighbor(cell); n != 0) pending_.push_back(n >> 1);
    }

    PatchTriangulation& mesh_;
    const PatchRaster& raster_;
    const TriangleCount& count_;
    DenseQuadtree<Cell> cells_;
    MergingDomain<PatchGrid, DenseSplitSet> domain_;
    CandidateQueue queue_;
    std::vector<CellCode> pending_;
    double squared_ = 0;
    std::size_t costed_ = 0;
};

}  // namespace

DenseQuadtree<float> saturated(const PatchGrid& grid, const DenseQuadtree<float>& deviation) {
    return saturated_with_kept(grid, deviation, {});
}

DecimationReport decimate(PatchTriangulation& mesh, const PatchRaster& raster, const DenseQuadtree<float>& deviation,
                          const DecimationOptions& options) {
    if (std::isnan(options.max_cost))
        throw Error(Fault::bad_usage, "max_cost", "not a number", "metres, or square metres a triangle");
    assert(deviation.levels() == mesh.levels());
    const TriangleCount count(raster);
    DecimationReport report;
    report.triangles_before = report.triangles = count.of_mesh(mesh);
    const std::vector<CellCode> kept = kept_cells(mesh, raster.lattice(), options.keep);
    const DenseQuadtree<float> cost = saturated_with_kept(mesh.topology(), deviation, kept);
    mesh = WeightlessRemoval(mesh, raster, cost).run();
    if (options.priority == DecimationPriority::max)
        decimate_by_largest(mesh, count, cost, options, report);
    else
        RmsDecimation(mesh, raster, count, cost).run(options, report);
    return report;
}

}  // namespace planet
