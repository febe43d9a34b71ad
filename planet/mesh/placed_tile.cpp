#include "planet/mesh/placed_tile.h"

#include <algorithm>

#include "planet/mesh/deviation.h"
#include "planet/mesh/exaggeration.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

std::vector<glm::dvec3> tile_normals(LocationCode root, int depth) {
    const TileLayout& layout = tile_layout();
    std::vector<glm::dvec3> n(layout.vertex_count[static_cast<std::size_t>(depth)]);
    const Corners c = corners(root);
    n[0] = c.left;
    n[1] = c.right;
    n[2] = c.apex;
    for (std::size_t v = 3; v < n.size(); ++v) n[v] = split_vertex(n[layout.ends[v][0]], n[layout.ends[v][1]]);
    return n;
}

PlacedTile::PlacedTile(const Tile& tile, const Placement& placement)
    : root(tile.root),
      depth(tile.depth),
      split(std::size_t{1} << tile.depth),
      height(tile.height),
      damaged(tile.damaged) {
    if (tile.child_exists.any()) {
        children_ = std::make_unique<std::atomic<const PlacedTile*>[]>(tile_cells);
        for (unsigned k = 0; k < tile_cells; ++k)
            if (!tile.child_exists[k]) children_[k] = this;
    }
    const TileLayout& layout = tile_layout();
    const std::vector<glm::dvec3> normals = tile_normals(root, depth);
    std::vector<glm::vec3> rounded(normals.size());
    position.resize(normals.size());
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const GeoidUndulation N = tile.undulation.empty() ? GeoidUndulation{} : tile.undulation[v];
        const glm::dvec3 p = placement.ecef(normals[v], static_cast<double>(tile.height[v]), N);
        position[v] = grid_from_ecef(p);
        rounded[v] = glm::vec3(p);
    }
    const Exaggeration exaggeration(placement.ellipsoid, placement.exaggeration);
    for (std::size_t i = 1; i < split.size(); ++i) {
        const glm::vec3& m = rounded[layout.split_vertex[i]];
        const int level = root.bisection_level() + static_cast<int>(std::bit_width(i)) - 1;
        split[i] = {m.x, m.y, m.z, tile.deviation[i], tile.radius[i]};
        if (placement.exaggeration == 1.0 || !(tile.deviation[i] > 0)) continue;
        const double deviation = static_cast<double>(tile.deviation[i]), radius = static_cast<double>(tile.radius[i]);
        split[i].deviation = next_up(static_cast<float>(exaggeration.deviation(deviation, level)));
        split[i].radius = next_up(static_cast<float>(exaggeration.radius(radius, level)));
    }
    if (children_) bound_children(tile, rounded, placement);
}

// The split vertex of a root below is not known here, but it lies near the middle of the chord of its split side: the
// plane of its cell meets its normal there, to second order, and the certified deviation bounds how far it is from that
// plane. 2 % of the side covers the second order and the roundings of an exaggerated record (see the constructor).
void PlacedTile::bound_children(const Tile& tile, const std::vector<glm::vec3>& rounded, const Placement& placement) {
    const TileLayout& layout = tile_layout();
    const Exaggeration exaggeration(placement.ellipsoid, placement.exaggeration);
    const double rounding = 2.0 * (1.0 + std::max(1.0, placement.exaggeration)) * (max_bisection_level + 1);
    const int level = root.bisection_level() + tile_levels;
    child_bound.assign(tile_cells, SplitRecord{0, 0, 0, 0, 0});
    for (std::size_t k = 0; k < tile_cells; ++k) {
        if (!tile.child_exists[k] || !(tile.child_deviation[k] > 0)) continue;
        const auto& corner = layout.corners[tile_cells + k];
        const glm::vec3 &a = rounded[corner[0]], &b = rounded[corner[1]];
        const glm::vec3 middle = 0.5f * (a + b);
        const double stored_radius = static_cast<double>(tile.child_radius[k]);
        const double deviation = exaggeration.deviation(static_cast<double>(tile.child_deviation[k]), level);
        const double radius = exaggeration.radius(stored_radius, level) + deviation +
                              0.02 * static_cast<double>(glm::distance(a, b)) + rounding;
        child_bound[k] = {middle.x, middle.y, middle.z, static_cast<float>(deviation * 1.0001),
                          static_cast<float>(radius * 1.0001)};
    }
}

bool PlacedTile::has_child_below(unsigned i) const {
    if (!children_) return false;
    const int below = tile_levels + 1 - static_cast<int>(std::bit_width(i));
    const unsigned first = (i << below) - tile_cells, end = ((i + 1) << below) - tile_cells;
    for (unsigned k = first; k < end; ++k)
        if (children_[k].load(std::memory_order_relaxed) != this) return true;
    return false;
}

const PlacedTile* PlacedTile::child(const TileSource& source, unsigned k) const {
    if (!children_) return nullptr;
    const PlacedTile* found = children_[k].load(std::memory_order_acquire);
    if (found == nullptr) {
        found = source.tile(LocationCode(root.bits() << tile_levels | k));
        children_[k].store(found ? found : this, std::memory_order_release);
    }
    return found == this ? nullptr : found;
}

}  // namespace planet
