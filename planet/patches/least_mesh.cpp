#include "planet/patches/least_mesh.h"

#include <bit>
#include <cmath>
#include <limits>
#include <queue>
#include <span>

#include "planet/patches/clip.h"

namespace planet {

PatchTriangulation coarsest(const PatchRaster& raster) {
    return PatchTriangulation(raster.grid(), raster.lattice().bisection_levels());
}

namespace {

// The largest float up to v: a float exceeds v if and only if it exceeds that.
float rounded_down(double v) {
    const auto f = static_cast<float>(v);
    return static_cast<double>(f) > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

// Calls on_index(i) for the values above a bound, in order. None is negative, so that they compare as integers do, which
// vector units take in one step.
template <class OnIndex>
void for_each_above(std::span<const float> values, float bound, OnIndex&& on_index) {
    constexpr std::size_t block = 16;
    for (std::size_t first = 0; first < values.size(); first += block) {
        const std::size_t end = std::min(first + block, values.size());
        std::int32_t largest = 0;
        for (std::size_t i = first; i < end; ++i) largest = std::max(largest, std::bit_cast<std::int32_t>(values[i]));
        if (!(std::bit_cast<float>(largest) > bound)) continue;
        for (std::size_t i = first; i < end; ++i)
            if (values[i] > bound) on_index(i);
    }
}

}  // namespace

// Level by level, so that deviations, which are more than a cache holds, are read from first to last. What closure splits
// on coarser levels leaves cells there that the scan has passed: these are followed at once.
void refine_to_tolerance(PatchTriangulation& mesh, const DenseQuadtree<float>& deviation, double tolerance) {
    const float bound = rounded_down(tolerance);
    const int root_bits = mesh.topology().root_bits();
    std::vector<CellCode> passed;
    for (int level = 0; level < mesh.levels(); ++level) {
        const auto follow_children = [&](CellCode cell) {
            const int below = mesh.level_of(cell) + 1;
            if (below > level) return;
            for (const CellCode child : {cell << 1, cell << 1 | 1})
                if (deviation.at(child, below) > bound) passed.push_back(child);
        };
        const auto split = [&](CellCode cell) {
            mesh.split(cell, [&](CellCode a, CellCode b) {
                follow_children(a);
                if (b != 0) follow_children(b);
            });
        };
        for_each_above(deviation.level(level), bound, [&](std::size_t i) {
            const CellCode cell = (CellCode{1} << (root_bits + level)) + i;
            if (!mesh.exists(cell)) return;
            split(cell);
            while (!passed.empty()) {
                const CellCode next = passed.back();
                passed.pop_back();
                split(next);
            }
        });
    }
}

std::size_t triangles_of_leaf(const PatchRaster& raster, const LatticeCorners& c) {
    if (raster.outside(c)) return 0;
    std::array<LatticeVertex, 3> triangle{{{c.left, 0}, {c.right, 0}, {c.apex, 0}}};
    for (LatticeVertex& v : triangle) {
        v.height = static_cast<double>(raster.at(v.at));
        if (std::isnan(v.height)) return 0;
    }
    if (raster.inside(c)) return 1;
    const std::size_t corners = clip(raster, triangle).count;
    return corners == 0 ? 0 : corners - 2;
}

bool refine_to_budget(PatchTriangulation& mesh, const PatchRaster& raster, const DenseQuadtree<float>& deviation,
                      std::size_t max_triangles) {
    const PatchLattice& lattice = raster.lattice();
    const int levels = mesh.levels();
    struct Candidate {
        float deviation;
        CellCode cell;
        bool operator<(const Candidate& o) const {
            return deviation != o.deviation ? deviation < o.deviation : cell > o.cell;
        }
    };
    std::priority_queue<Candidate> queue;
    std::size_t triangles = 0;
    const auto add_leaf = [&](CellCode cell, const LatticeCorners& corners) {
        triangles += triangles_of_leaf(raster, corners);
        const int level = mesh.level_of(cell);
        if (level < levels && deviation.at(cell, level) > 0) queue.push({deviation.at(cell, level), cell});
    };
    mesh.for_each_leaf([&](CellCode leaf) { add_leaf(leaf, lattice.corners(leaf)); });
    if (triangles > max_triangles) return false;

    const auto replace_by_children = [&](CellCode cell) {
        const LatticeCorners c = lattice.corners(cell);
        triangles -= triangles_of_leaf(raster, c);
        for (unsigned i = 0; i < 2; ++i) add_leaf(cell << 1 | i, PatchLattice::child(c, i));
    };
    std::vector<CellCode> done;  // in order, to go back by
    std::size_t best = 0;
    float best_deviation = std::numeric_limits<float>::infinity();
    while (triangles <= max_triangles) {
        while (!queue.empty() && mesh.is_split(queue.top().cell)) queue.pop();
        const float worst = queue.empty() ? 0 : queue.top().deviation;
        if (worst < best_deviation || done.empty()) {
            best_deviation = worst;
            best = done.size();
        }
        if (queue.empty()) break;
        const CellCode cell = queue.top().cell;
        queue.pop();
        mesh.split(cell, [&](CellCode a, CellCode b) {
            done.push_back(a);
            replace_by_children(a);
            if (b != 0) replace_by_children(b);
        });
    }
    for (; done.size() > best; done.pop_back()) mesh.merge(done.back());
    return true;
}

void refine_to_level(PatchTriangulation& mesh, int level) {
    for (int l = 0; l < level; ++l)
        for (int rank = 0; rank < mesh.topology().root_count(); ++rank)
            for (CellCode c = mesh.topology().root(rank) << l; c < (mesh.topology().root(rank) + 1) << l; ++c)
                mesh.split_cells().insert(c);
}

void keep_sample(PatchTriangulation& mesh, const PatchLattice& lattice, glm::ivec2 sample) {
    if (const auto cell = lattice.cell_split_at(sample)) mesh.split(*cell);
}

}  // namespace planet
