#include "planet/store/coverage.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "planet/error.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

Cap cap_of(const Corners& c) {
    const glm::dvec3 centre = glm::normalize(c.left + c.right + c.apex);
    double chord = 0;
    for (const glm::dvec3& corner : {c.left, c.right, c.apex}) chord = std::max(chord, glm::length(corner - centre));
    return {centre, 2 * std::asin(std::min(1.0, chord / 2)) * (1 + 1e-9) + 1e-15};
}

class Planner {
  public:
    Planner(const ElevationField& field, const CoverageLimits& limits) : field_(field), limits_(limits) {}

    std::vector<PlannedTile> plan() {
        for (int face = 0; face < face_count; ++face) want(LocationCode::face_root(face), face_corners(face));
        std::vector<LocationCode> wanted;
        for (const auto& [root, depths] : tiles_) wanted.push_back(LocationCode(root));
        std::sort(wanted.begin(), wanted.end());
        for (const LocationCode root : wanted) pad(root);

        std::vector<PlannedTile> planned;
        for (const auto& [root, depths] : tiles_)
            planned.push_back({LocationCode(root), depths.any(), parents_.contains(root)});
        std::sort(planned.begin(), planned.end(), [](auto& a, auto& b) { return a.root < b.root; });
        return planned;
    }

  private:
    struct Depths {
        int wanted = 0;  ///< every diamond of cells above this depth must exist
        int needed = 0;  ///< some must, for other tiles
        int any() const { return std::max(wanted, needed); }
    };

    int finest_level(const Corners& c) const {
        const double spacing = field_.spacing(cap_of(c));
        int level = std::isfinite(spacing) ? level_for_spacing(spacing, limits_.mean_radius_m) : 0;
        if (level > 0) level += limits_.extra_levels;
        return std::min(std::max(level, limits_.least_level), limits_.finest_level);
    }

    // A tile whose place asks for more than the lattice above it, and those below.
    void want(LocationCode root, const Corners& c) {
        const int wanted = finest_level(c) - root.bisection_level();
        if (wanted <= 0) return;
        deepen(root, std::min(wanted, tile_levels), 0);
        if (wanted > tile_levels) want_below(root, c, tile_levels);
    }

    void want_below(LocationCode cell, const Corners& c, int levels) {
        if (levels == 0) return want(cell, c);
        if (levels < tile_levels && finest_level(c) <= cell.bisection_level() + levels) return;
        const glm::dvec3 m = split_vertex(c);
        for (int i = 0; i < 2; ++i) want_below(cell.child(i), child_corners(c, m, i), levels - 1);
    }

    void pad(LocationCode root) {
        const int depth = tiles_.at(root.bits()).wanted;
        if (root.bisection_level() > 0) require(root.parent());
        for (const SideCell& s : side_cells(depth)) require(neighbor(cell_code(root, s.cell)));
    }

    // The diamond of this cell must exist, and so all it depends on.
    void require(LocationCode cell) {
        const auto [root, local] = cell_in_tile(cell);
        const int depth = relative_level(local) + 1;
        if (const auto known = tiles_.find(root.bits()); known != tiles_.end() && known->second.wanted >= depth) return;
        if (!required_.insert(cell.bits()).second) return;
        charge(48);
        deepen(root, 0, depth);
        if (cell.bisection_level() > 0) require(cell.parent());
        require(neighbor(cell));
    }

    void deepen(LocationCode root, int wanted, int needed) {
        const bool has_parent = root.bisection_level() > 0;
        if (has_parent && parents_.insert(root.bits() >> tile_levels).second)
            charge(planned_bytes({{}, tile_levels, true}) - planned_bytes({{}, tile_levels, false}));
        Depths& tile = tiles_[root.bits()];
        const std::size_t before = tile.any() ? planned_bytes({root, tile.any(), false}) : 0;
        tile.wanted = std::max(tile.wanted, wanted);
        tile.needed = std::max(tile.needed, needed);
        charge(planned_bytes({root, tile.any(), false}) - before);
    }

    void charge(std::size_t bytes) {
        bytes_ += bytes;
        if (bytes_ <= limits_.memory_bytes) return;
        throw Error(Fault::bad_usage, "bake",
                    "down to bisection level " + std::to_string(limits_.finest_level) +
                        " this elevation needs more than " + std::to_string(limits_.memory_bytes >> 20) +
                        " MiB of memory",
                    "a lower finest level or a larger memory limit");
    }

    const ElevationField& field_;
    const CoverageLimits& limits_;
    std::unordered_map<std::uint64_t, Depths> tiles_;
    std::unordered_set<std::uint64_t> parents_;
    std::unordered_set<std::uint64_t> required_;
    std::size_t bytes_ = 0;
};

}  // namespace

Cap cap_of(LocationCode cell) {
    return cap_of(corners(cell));
}

std::size_t planned_bytes(const PlannedTile& tile) {
    // As BakedTile holds them: by vertex height, undulation, rounded position; by cell deviation, radius, existence.
    const std::size_t vertices = tile_layout().vertex_count[static_cast<std::size_t>(tile.depth)];
    const std::size_t records = std::size_t{1} << tile.depth;
    return 1536 + vertices * (4 + 8 + 12) + records * (4 + 4 + 1) + (tile.has_children ? 4 * tile_cells : 0);
}

std::vector<PlannedTile> coverage(const ElevationField& field, const CoverageLimits& limits) {
    return Planner(field, limits).plan();
}

}  // namespace planet
