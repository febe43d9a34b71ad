#include "planet/bake/coverage.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "planet/bake/layer_choice.h"
#include "planet/error.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

TilePlan::Place TilePlan::place(LocationCode root) const {
    if (root.bisection_level() == 0) return {0, root.bits()};
    return {layers_.above(root).bits(), layers_.position(root)};
}

LocationCode TilePlan::root_at(std::uint64_t block, std::size_t index) const {
    return block == 0 ? LocationCode(index) : layers_.below(LocationCode(block), index);
}

TilePlan::Depths TilePlan::at(LocationCode root) const {
    const auto [block, index] = place(root);
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? Depths{} : found->second->depths[index];
}

int TilePlan::depth(LocationCode root) const {
    return at(root).any();
}

bool TilePlan::is_whole(LocationCode root) const {
    const Depths d = at(root);
    return d.wanted >= d.needed;
}

bool TilePlan::has_record(LocationCode cell) const {
    const auto [root, local] = cell_in_tile(cell, layers_);
    return relative_level(local) < at(root).any();
}

bool TilePlan::is_in_whole_part(LocationCode cell) const {
    const auto [root, local] = cell_in_tile(cell, layers_);
    return relative_level(local) < at(root).wanted;
}

std::vector<LocationCode> TilePlan::below(LocationCode root) const {
    std::vector<LocationCode> roots;
    const auto found = blocks_.find(root.bits());
    if (found == blocks_.end()) return roots;
    for (std::size_t k = 0; k < tile_cells; ++k)
        if (found->second->depths[k].any() > 0) roots.push_back(layers_.below(root, k));
    return roots;
}

bool TilePlan::is_final(LocationCode root) const {
    const auto [block, index] = place(root);
    return blocks_.at(block)->final[index];
}

void TilePlan::mark_final(LocationCode root) {
    const auto [block, index] = place(root);
    blocks_.at(block)->final.set(index);
}

void TilePlan::count() {
    for (const auto& [above, block] : blocks_) {
        for (std::size_t k = 0; k < tile_cells; ++k) {
            const int depth = block->depths[k].any();
            if (depth == 0) continue;
            const LocationCode root = root_at(above, k);
            ++tiles_;
            const std::uint64_t vertices = tile_layout().vertex_count[static_cast<std::size_t>(depth)];
            vertices_ += vertices;
            vertices_by_level_[root.bisection_level()] += vertices;
            finest_level_ = std::max(finest_level_, root.bisection_level() + depth);
        }
    }
}

int finest_level_in(const Corners& cell, const ElevationField& field, const CoverageLimits& limits) {
    const double spacing = field.spacing(cap_of(cell));
    int level = std::isfinite(spacing) ? level_for_spacing(spacing, limits.mean_radius_m) : 0;
    if (level > 0) level += limits.extra_levels;
    return std::min(std::max(level, limits.least_level), limits.finest_level);
}

class CoveragePlanner {
  public:
    CoveragePlanner(const ElevationField& field, const CoverageLimits& limits, TileLayers layers)
        : field_(field), limits_(limits), layers_(layers), plan_(layers) {}

    TilePlan plan() {
        for (int face = 0; face < face_count; ++face) want(LocationCode::face_root(face), face_corners(face));
        std::vector<std::uint64_t> blocks;  // padding makes more
        for (const auto& [above, block] : plan_.blocks_) blocks.push_back(above);
        for (const std::uint64_t above : blocks) {
            const TilePlan::Block& block = *plan_.blocks_.at(above);
            for (std::size_t k = 0; k < tile_cells; ++k)
                if (block.depths[k].wanted > 0) pad(plan_.root_at(above, k));
        }
        plan_.count();
        return std::move(plan_);
    }

  private:
    int finest_level(const Corners& c) const { return finest_level_in(c, field_, limits_); }

    // A tile whose place asks for more than the lattice above it, and those below.
    void want(LocationCode root, const Corners& c) {
        const int wanted = finest_level(c) - root.bisection_level();
        if (wanted <= 0) return;
        const int deepest = layers_.depth(root.bisection_level());
        deepen(root, std::min(wanted, deepest), 0);
        if (wanted > deepest) want_below(root, c, deepest);
    }

    void want_below(LocationCode cell, const Corners& c, int levels) {
        if (levels == 0) return want(cell, c);
        if (finest_level(c) <= cell.bisection_level() + levels) return;
        const glm::dvec3 m = split_vertex(c);
        for (int i = 0; i < 2; ++i) want_below(cell.child(i), child_corners(c, m, i), levels - 1);
    }

    // The tile above a wanted one is whole; so nothing is left to require if those beside it are as deep.
    void pad(LocationCode root) {
        const int depth = plan_.at(root).wanted;
        const auto is_as_deep = [&](Side side) { return plan_.at(neighbor(root, side)).wanted >= depth; };
        if (is_as_deep(Side::split) && is_as_deep(Side::left_leg) && is_as_deep(Side::right_leg)) return;
        if (root.bisection_level() > 0) require(root.parent());
        for (const SideCell& s : side_cells(depth)) require(neighbor(cell_code(root, s.cell)));
    }

    // The diamond of this cell must exist, and so all it depends on.
    void require(LocationCode cell) {
        if (plan_.is_in_whole_part(cell)) return;
        const auto [root, local] = cell_in_tile(cell, layers_);
        const auto [known, is_new] = required_.try_emplace(root.bits());
        if (is_new) {
            charge(sizeof(std::bitset<tile_cells>) + 64);
            known->second = std::make_unique<std::bitset<tile_cells>>();
        }
        if (known->second->test(local)) return;
        known->second->set(local);
        deepen(root, 0, relative_level(local) + 1);
        if (cell.bisection_level() > 0) require(cell.parent());
        require(neighbor(cell));
    }

    void deepen(LocationCode root, int wanted, int needed) {
        const auto [block, index] = plan_.place(root);
        const auto [found, is_new] = plan_.blocks_.try_emplace(block);
        if (is_new) {
            charge(sizeof(TilePlan::Block) + 64);
            found->second = std::make_unique<TilePlan::Block>();
        }
        TilePlan::Depths& d = found->second->depths[index];
        d.wanted = static_cast<std::uint8_t>(std::max<int>(d.wanted, wanted)) & 15u;
        d.needed = static_cast<std::uint8_t>(std::max<int>(d.needed, needed)) & 15u;
    }

    void charge(std::size_t bytes) {
        bytes_ += bytes;
        if (bytes_ <= limits_.memory_bytes) return;
        throw Error(Fault::bad_usage, "bake",
                    "down to bisection level " + std::to_string(limits_.finest_level) +
                        " the plan alone needs more than " + std::to_string(limits_.memory_bytes >> 20) +
                        " MiB of memory",
                    "a lower finest level or a larger memory limit");
    }

    const ElevationField& field_;
    const CoverageLimits& limits_;
    TileLayers layers_;
    TilePlan plan_;
    std::unordered_map<std::uint64_t, std::unique_ptr<std::bitset<tile_cells>>> required_;  // by tile: local indices
    std::size_t bytes_ = 0;
};

TilePlan coverage(const ElevationField& field, const CoverageLimits& limits) {
    const TileLayers layers =
        limits.first_tile_level > 0 ? TileLayers{limits.first_tile_level} : cheapest_layers(field, limits);
    return CoveragePlanner(field, limits, layers).plan();
}

}  // namespace planet
