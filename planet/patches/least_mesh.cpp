#include "planet/patches/least_mesh.h"

#include <queue>

#include "planet/patches/clip.h"

namespace planet {

PatchTriangulation coarsest(const PatchRaster& raster) {
    return PatchTriangulation(raster.grid(), raster.lattice().bisection_levels());
}

void refine_to_tolerance(PatchTriangulation& mesh, const DenseQuadtree<float>& deviation, double tolerance) {
    std::vector<CellCode> pending;
    const int levels = mesh.levels();
    const auto too_far = [&](CellCode cell) {
        const int level = mesh.level_of(cell);
        return level<levels&& static_cast<double>(deviation.at(cell, level))> tolerance;
    };
    mesh.for_each_leaf([&](CellCode leaf) {
        if (too_far(leaf)) pending.push_back(leaf);
    });
    const auto add_children = [&](CellCode cell) {
        for (const CellCode child : {cell << 1 | 1, cell << 1})
            if (too_far(child)) pending.push_back(child);
    };
    while (!pending.empty()) {
        const CellCode cell = pending.back();
        pending.pop_back();
        mesh.split(cell, [&](CellCode a, CellCode b) {
            if (b != 0) add_children(b);
            add_children(a);
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
