// The closure part of the certificate: sizes of merging domains, measured by removing vertices, beside those of
// Balmelli, Kovacevic and Vetterli, "Solving the Coplanarity Problem of Regular Embedded Triangulations": proposition
// 3.1 for one vertex, 3.2 for the worst one and the mean.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include "planet/quadtree/patch_lattice.h"
#include "planet/quadtree/triangulation.h"
#include "render/app/check/check_parts.h"
#include "render/app/table.h"

namespace render {
namespace {

using planet::CellCode;
using planet::check_row;

constexpr int largest_patch = 12;       // quadtree levels: 2^25 triangles a patch
constexpr int largest_whole_mean = 10;  // every vertex of a patch of 2^20 of them
constexpr int largest_checked = 8;      // checking walks all triangles

/// Every cell split, and again after a removal: one bit a cell.
class FullMesh {
  public:
    FullMesh(planet::PatchGrid grid, int quadtree_levels) : mesh_(grid, 2 * quadtree_levels) {
        for (int rank = 0; rank < grid.root_count(); ++rank) mesh_.split_cells().fill(grid.root(rank));
    }
    const planet::PatchGrid& grid() const { return mesh_.topology(); }

    /// Removes a vertex and puts its merging domain back. @return how many triangles merged
    template <class Between>
    std::size_t try_removal(CellCode cell, Between&& between) {
        merged_.clear();
        const std::size_t count = mesh_.remove(cell, [&](CellCode c, int) { merged_.push_back(c); });
        between(mesh_);
        for (const CellCode c : merged_) mesh_.split_cells().fill(c);
        return count;
    }
    std::size_t try_removal(CellCode cell) {
        return try_removal(cell, [](const auto&) {});
    }

  private:
    planet::Triangulation<planet::PatchGrid, planet::DenseSplitSet> mesh_;
    std::vector<CellCode> merged_;
};

std::string fixed(double value, int digits) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(digits);
    text << std::fixed << value;
    return text.str();
}

/// Removes the centre of the middle of 3 x 3 patches of 2^(2 d + 1) triangles, d = 4 ..
CheckPart check_worst_case() {
    CheckPart part;
    std::vector<std::vector<std::string>> table{{"n", "vertices a patch", "m(1, n)", "formula", "m / sqrt(n)"}};
    double faults = 0, ratio = 0;
    for (int d = 4; d <= largest_patch; ++d) {
        FullMesh full(planet::PatchGrid(3, 3), d);
        const std::size_t merged = full.try_removal(full.grid().root_of_patch(1, 1, 0), [&](const auto& mesh) {
            if (d <= largest_checked && mesh.check()) ++faults;
        });
        const auto formula = static_cast<double>(planet::merging_domain_size(2 * d));
        const double m = static_cast<double>(merged), side = std::ldexp(1, d) + 1;
        ratio = m / std::sqrt(std::ldexp(1, 2 * d + 1));
        const std::string n = "2^" + std::to_string(2 * d + 1);
        table.push_back({n, fixed(side * side, 0), std::to_string(merged), fixed(formula, 0), fixed(ratio, 4)});
        part.rows.push_back(check_row("merging domain of a patch's centre, n = " + n + ", from m(1, n)",
                                      std::abs(m - formula), 0, "1"));
    }
    table.push_back({"", "", "", "10 sqrt(2)", fixed(10 * std::numbers::sqrt2, 4)});
    part.rows.push_back(check_row("m(1, n) / sqrt(n) from 10 sqrt(2), n = 2^" + std::to_string(2 * largest_patch + 1),
                                  std::abs(ratio - 10 * std::numbers::sqrt2), 0.04, "1"));
    part.rows.push_back(check_row("meshes not conforming after a removal", faults, 0, "1"));
    std::ostringstream text;
    text << "triangles merged by the removal of the centre of the middle of 3 x 3 patches of n triangles\n";
    print_table(text, table);
    part.tables = text.str();
    return part;
}

/// By spreading steps, from 1: vertices of falling labels near the middle of 3 x 3 patches.
std::vector<std::size_t> measured_domains() {
    FullMesh full(planet::PatchGrid(3, 3), largest_patch);
    const planet::PatchLattice lattice(full.grid(), largest_patch);
    std::vector<std::size_t> domains{0};
    for (int i = 1; i <= 2 * largest_patch; ++i) {
        const int label = 2 * largest_patch + 1 - i, k = (label - 1) / 2;
        const int middle = 3 * lattice.patch_size() / 2, step = lattice.patch_size() >> (k + 1);
        glm::ivec2 vertex(middle);
        if (k > 0) vertex.y += step;
        if (label % 2 == 1 && k > 0) vertex.x += step;
        if (label == 2) vertex.x -= step;
        domains.push_back(full.try_removal(*lattice.cell_split_at(vertex)));
    }
    return domains;
}

struct Mean {
    double of_domains = 0;
    std::size_t largest = 0, vertices = 0;
};

Mean mean_over_patch(int quadtree_levels) {
    FullMesh full(planet::PatchGrid(1, 1), quadtree_levels);
    Mean mean;
    std::size_t sum = 0;
    for (int level = 0; level < 2 * quadtree_levels; ++level)
        for (CellCode c = CellCode{2} << level; c < CellCode{4} << level; ++c) {
            if (planet::diamond(full.grid(), c) != c) continue;
            const std::size_t merged = full.try_removal(c);
            sum += merged;
            mean.largest = std::max(mean.largest, merged);
            ++mean.vertices;
        }
    mean.of_domains = static_cast<double>(sum) / static_cast<double>(mean.vertices);
    return mean;
}

CheckPart check_mean() {
    CheckPart part;
    std::vector<std::vector<std::string>> table{
        {"i", "m(i)", "formula", "unbounded mean", "mean of a patch", "its largest", "its vertices"}};
    const std::vector<std::size_t> domains = measured_domains();
    double unbounded = 0, off = 0, largest_mean = 0;
    for (int i = 1; i <= 2 * largest_patch; ++i) {
        const auto m = static_cast<double>(domains[static_cast<std::size_t>(i)]);
        const auto formula = static_cast<double>(planet::merging_domain_size(i));
        unbounded += std::ldexp(m, -i);
        off = std::max(off, std::abs(m - formula));
        table.push_back({std::to_string(i), fixed(m, 0), fixed(formula, 0), fixed(unbounded, 4)});
        if (i % 2 != 0 || i / 2 > largest_whole_mean) continue;
        const Mean mean = mean_over_patch(i / 2);
        largest_mean = std::max(largest_mean, mean.of_domains);
        for (const auto& cell :
             {fixed(mean.of_domains, 4), std::to_string(mean.largest), std::to_string(mean.vertices)})
            table.back().push_back(cell);
    }
    part.rows = {check_row("merging domains of 1 to 24 steps from m(i)", off, 0, "1"),
                 check_row("unbounded mean of merging domains from 14", std::abs(unbounded - 14), 0.02, "1"),
                 check_row("largest mean over every vertex of a patch", largest_mean, 14, "1")};
    std::ostringstream text;
    text << "triangles merged by a vertex of i spreading steps; the mean over all labels, one in 2^i each; and over "
            "every "
            "vertex of a patch of i levels, whose border cuts domains short\n";
    print_table(text, table);
    part.tables = text.str();
    return part;
}

}  // namespace

CheckPart check_closure() {
    CheckPart worst = check_worst_case(), mean = check_mean();
    worst.rows.insert(worst.rows.end(), mean.rows.begin(), mean.rows.end());
    worst.tables += "\n" + mean.tables;
    return worst;
}

}  // namespace render
