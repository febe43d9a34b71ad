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
    : root(tile.root), depth(tile.depth), height(tile.height), damaged(tile.damaged), stored_(tile.height.size()) {
    child_bound.depth_ = depth;
    for (const GeoidUndulation N : tile.undulation) undulation_.push_back(static_cast<float>(N.m));
    for (std::size_t i = 1; i < tile.deviation.size(); ++i)
        stored_[tile_layout().split_vertex[i]] = {tile.deviation[i], tile.radius[i]};
    if (tile.child_exists.any()) note_children(tile);
    place(placement);
}

void PlacedTile::note_children(const Tile& tile) {
    ChildBounds& c = child_bound;
    std::size_t children = 0;
    for (std::size_t word = 0; word < c.exists_.size(); ++word) {
        c.rank_[word] = static_cast<std::uint16_t>(children);
        for (std::size_t bit = 0; bit < 64; ++bit)
            c.exists_[word] |= std::uint64_t{tile.child_exists[64 * word + bit]} << bit;
        children += static_cast<std::size_t>(std::popcount(c.exists_[word]));
    }
    for (unsigned i = std::min(127u, (2u << depth) - 1); i >= 1; --i) {
        const bool any = i >= 64 || i >> depth ? c.has_any_of_word(i) : c.has_below(2 * i) || c.has_below(2 * i + 1);
        c.any_[i >> 6] |= std::uint64_t{any} << (i & 63);
    }
    c.below_ = std::vector<ChildBounds::Below>(children);
    for (unsigned k = 0; k < 1u << depth; ++k)
        if (c.has(k)) c.below_[c.index(k)].stored = {tile.child_deviation[k], tile.child_radius[k]};
}

PlacedTile::PlacedTile(const PlacedTile& other, const Placement& placement)
    : root(other.root),
      depth(other.depth),
      height(other.height),
      damaged(other.damaged),
      undulation_(other.undulation_),
      stored_(other.height.size()) {
    child_bound.exists_ = other.child_bound.exists_;
    child_bound.rank_ = other.child_bound.rank_;
    child_bound.any_ = other.child_bound.any_;
    child_bound.depth_ = other.child_bound.depth_;
    child_bound.below_ = std::vector<ChildBounds::Below>(other.child_bound.below_.size());
    for (std::size_t v = 3; v < stored_.size(); ++v) stored_[v] = other.stored(v);
    for (std::size_t k = 0; k < child_bound.below_.size(); ++k)
        child_bound.below_[k].stored = other.child_bound.below_[k].stored;
    place(placement);
    for (std::size_t v = 3; v < height.size(); ++v) {
        float& deviation = split.by_vertex_[v].deviation;
        deviation = std::copysign(deviation, other.split.by_vertex_[v].deviation);
    }
}

PlacedTile::StoredRecord PlacedTile::stored(std::size_t vertex) const {
    if (!stored_.empty()) return stored_[vertex];
    const SplitRecord& s = split.by_vertex_[vertex];
    return {std::abs(s.deviation), s.radius};
}

void PlacedTile::place(const Placement& placement) {
    TileLattice lattice;
    std::vector<GeoidUndulation> undulation(undulation_.size());
    for (std::size_t v = 0; v < undulation.size(); ++v) undulation[v].m = static_cast<double>(undulation_[v]);
    lattice.set_normals(corners(root), depth);
    lattice.set_positions(placement, height, undulation, {});
    position.resize(lattice.size());
    for (std::size_t v = 0; v < lattice.size(); ++v) position[v] = grid_from_ecef(lattice.position(v));
    place_records(lattice.rounded(), placement);
    if (!child_bound.empty()) bound_children(lattice.rounded(), placement);
    if (placement.exaggeration == 1.0) stored_ = {};
}

void PlacedTile::place_records(std::span<const glm::vec3> rounded, const Placement& placement) {
    const TileLayout& layout = tile_layout();
    const Exaggeration exaggeration(placement.ellipsoid, placement.exaggeration);
    split.by_vertex_.assign(rounded.size(), SplitRecord{});
    for (int k = 0; k < depth; ++k) {
        const int level = root.bisection_level() + k;
        const auto first = layout.vertex_count[static_cast<std::size_t>(k)],
                   end = layout.vertex_count[static_cast<std::size_t>(k) + 1];
        StoredRecord& most_here = most[static_cast<std::size_t>(k)];
        for (std::size_t v = first; v < end; ++v) {
            const glm::vec3& m = rounded[v];
            const StoredRecord s = stored_[v];
            SplitRecord& record = split.by_vertex_[v];
            record = {m.x, m.y, m.z, s.deviation, s.radius};
            if (placement.exaggeration != 1.0 && s.deviation > 0) {
                record.deviation =
                    next_up(static_cast<float>(exaggeration.deviation(static_cast<double>(s.deviation), level)));
                record.radius = next_up(static_cast<float>(exaggeration.radius(static_cast<double>(s.radius), level)));
            }
            most_here.deviation = std::max(most_here.deviation, record.deviation);
            most_here.radius = std::max(most_here.radius, record.radius);
        }
    }
}

// The split vertex of a root below is not known here, but it lies near the middle of the chord of its split side: the
// plane of its cell meets its normal there, to second order, and the certified deviation bounds how far it is from that
// plane. 2 % of the side covers the second order and the roundings of an exaggerated record (see Exaggeration).
void PlacedTile::bound_children(std::span<const glm::vec3> rounded, const Placement& placement) {
    const TileLayout& layout = tile_layout();
    const Exaggeration exaggeration(placement.ellipsoid, placement.exaggeration);
    const double rounding = 2.0 * (1.0 + std::max(1.0, placement.exaggeration)) * (max_bisection_level + 1);
    const int level = root.bisection_level() + depth;
    for (unsigned k = 0; k < 1u << depth; ++k) {
        if (!child_bound.has(k)) continue;
        ChildBounds::Below& below = child_bound.below_[child_bound.index(k)];
        below.bound = {};
        if (!(below.stored.deviation > 0)) continue;
        const auto& corner = layout.corners[(1u << depth) + k];
        const glm::vec3 &a = rounded[corner[0]], &b = rounded[corner[1]];
        const glm::vec3 middle = 0.5f * (a + b);
        const double deviation = exaggeration.deviation(static_cast<double>(below.stored.deviation), level);
        const double radius = exaggeration.radius(static_cast<double>(below.stored.radius), level) + deviation +
                              0.02 * static_cast<double>(glm::distance(a, b)) + rounding;
        below.bound = {middle.x, middle.y, middle.z, static_cast<float>(deviation * 1.0001),
                       static_cast<float>(radius * 1.0001)};
    }
}

void PlacedTile::close() {
    for (SplitRecord& s : split.by_vertex_) s.deviation = -std::abs(s.deviation);
}

const PlacedTile* PlacedTile::child_at(const TileSource& source, unsigned k) const {
    const ChildBounds::Below& below = child_bound.below_[child_bound.index(k)];
    if (below.known.load(std::memory_order_acquire)) return below.tile.load(std::memory_order_relaxed);
    const PlacedTile* tile = source.tile(LocationCode(root.bits() << depth | k));
    below.tile.store(tile, std::memory_order_relaxed);
    below.known.store(true, std::memory_order_release);
    return tile;
}

void PlacedTile::set_child(unsigned k, const PlacedTile* tile) {
    const ChildBounds::Below& below = child_bound.below_[child_bound.index(k)];
    below.tile.store(tile, std::memory_order_relaxed);
    below.known.store(true, std::memory_order_release);
}

void PlacedTile::set_no_children() {
    for (const ChildBounds::Below& below : child_bound.below_) {
        below.tile.store(nullptr, std::memory_order_relaxed);
        below.known.store(true, std::memory_order_release);
    }
}

std::size_t PlacedTile::bytes() const {
    return sizeof *this + split.by_vertex_.size() * sizeof(SplitRecord) + position.size() * sizeof(GridPosition) +
           (height.size() + undulation_.size()) * sizeof(float) + stored_.size() * sizeof(StoredRecord) +
           child_bound.below_.size() * sizeof(ChildBounds::Below);
}

}  // namespace planet
