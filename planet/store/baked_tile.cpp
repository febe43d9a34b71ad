#include "planet/store/baked_tile.h"

#include <algorithm>
#include <cassert>
#include <unordered_map>

#include "planet/store/ladder.h"

namespace planet {

namespace {

using TileIndex = std::unordered_map<std::uint64_t, std::int32_t>;

std::int32_t find(const TileIndex& index, LocationCode root) {
    const auto found = index.find(root.bits());
    return found == index.end() ? -1 : found->second;
}

void tie_tile(std::vector<BakedTile>& tiles, const TileIndex& index, std::size_t t) {
    BakedTile& tile = tiles[t];
    const LocationCode root = tile.tile.root;
    for (const Side side : {Side::split, Side::left_leg, Side::right_leg})
        tile.beside[static_cast<std::size_t>(side)] = find(index, neighbor(root, side));
    if (root.bisection_level() == 0) return;
    tile.above = find(index, root.ancestor(root.bisection_level() - tile_levels));
    assert(tile.above >= 0);
    BakedTile& parent = tiles[static_cast<std::size_t>(tile.above)];
    const std::uint64_t position = root.bits() & (tile_cells - 1);
    parent.below.resize(tile_cells, -1);
    parent.below[position] = static_cast<std::int32_t>(t);
    parent.tile.child_exists.set(position);
}

// Whether cell i's record is there and the diamond of its parent exists.
bool may_exist(const std::vector<BakedTile>& tiles, const BakedTile& tile, unsigned i) {
    if (i >> tile.tile.depth) return false;
    if (i > 1) return tile.exists[i >> 1];
    if (tile.above < 0) return true;
    const unsigned above = tile_cells | static_cast<unsigned>(tile.tile.root.bits() & (tile_cells - 1));
    return tiles[static_cast<std::size_t>(tile.above)].exists[above >> 1];
}

// The other tile of a side cell, if it is there, and the cell's local index in it.
std::pair<std::int32_t, unsigned> across(const BakedTile& tile, SideCell s) {
    const CellInTile other = cell_in_tile(neighbor(cell_code(tile.tile.root, s.cell)));
    return {tile.beside[static_cast<std::size_t>(s.side)], other.local};
}

void find_existence(std::vector<BakedTile>& tiles, BakedTile& tile, int level) {
    const TileLayout& layout = tile_layout();
    const unsigned first = 1u << level;
    for (unsigned i = first; i < 2 * first; ++i) {
        const unsigned beyond = layout.split_neighbor[i];
        if (beyond != 0) tile.exists[i] = may_exist(tiles, tile, i) && may_exist(tiles, tile, beyond);
    }
    for (const SideCell& s : side_cells(tile.tile.depth)) {
        if (relative_level(s.cell) != level) continue;
        const auto [beside, local] = across(tile, s);
        tile.exists[s.cell] = may_exist(tiles, tile, s.cell) && beside >= 0 &&
                              may_exist(tiles, tiles[static_cast<std::size_t>(beside)], local);
    }
}

}  // namespace

std::vector<BakedTile> tie_tiles(const std::vector<PlannedTile>& plan) {
    std::vector<BakedTile> tiles(plan.size());
    TileIndex index;
    index.reserve(plan.size());
    for (std::size_t t = 0; t < plan.size(); ++t) {
        tiles[t].tile.root = plan[t].root;
        tiles[t].tile.depth = plan[t].depth;
        tiles[t].exists.assign(std::size_t{1} << plan[t].depth, 0);
        index.emplace(plan[t].root.bits(), static_cast<std::int32_t>(t));
    }
    for (std::size_t t = 0; t < tiles.size(); ++t) tie_tile(tiles, index, t);
    // From the coarsest level down: a level needs the one above it in every tile.
    for (std::size_t begin = 0; begin < tiles.size();) {
        const int root_level = tiles[begin].tile.root.bisection_level();
        std::size_t end = begin;
        while (end < tiles.size() && tiles[end].tile.root.bisection_level() == root_level) ++end;
        for (int level = 0; level < tile_levels; ++level)
            for (std::size_t t = begin; t < end; ++t)
                if (level < tiles[t].tile.depth) find_existence(tiles, tiles[t], level);
        begin = end;
    }
    return tiles;
}

void Saturation::raise(unsigned i) const {
    if (!exists[i]) {
        deviation[i] = radius[i] = 0;
        return;
    }
    if (i >> (depth - 1)) return;
    const glm::vec3& m = rounded[layout.split_vertex[i]];
    double reach = 0;
    for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
        if (!exists[child]) continue;
        deviation[i] = std::max(deviation[i], deviation[child]);
        reach = std::max(reach, radius_over(m, rounded[layout.split_vertex[child]], radius[child]));
    }
    radius[i] = std::max(radius[i], certified_radius(reach));
}

void Saturation::join(unsigned i, unsigned beyond) const {
    deviation[i] = deviation[beyond] = std::max(deviation[i], deviation[beyond]);
    radius[i] = radius[beyond] = std::max(radius[i], radius[beyond]);
}

namespace {

// Raises a cell of an inner tile's last level over the diamonds of the tiles below it.
void raise_over_tiles(std::span<BakedTile> tiles, BakedTile& tile, unsigned i) {
    if (!tile.exists[i]) return;
    const glm::vec3& m = tile.rounded[tile_layout().split_vertex[i]];
    double reach = 0;
    for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
        const std::int32_t below = tile.below[child - tile_cells];
        if (below < 0) continue;
        const BakedTile& b = tiles[static_cast<std::size_t>(below)];
        if (!b.exists[1]) continue;
        tile.tile.deviation[i] = std::max(tile.tile.deviation[i], b.tile.deviation[1]);
        reach = std::max(reach, radius_over(m, b.rounded[tile_layout().split_vertex[1]], b.tile.radius[1]));
    }
    tile.tile.radius[i] = std::max(tile.tile.radius[i], certified_radius(reach));
}

float up_the_deviations(float deviation) {
    return deviation_from_code(deviation_code(deviation));
}
float up_the_radii(float radius) {
    return radius_from_code(radius_code(radius));
}

void settle_inside(std::span<BakedTile> tiles, BakedTile& tile, int level) {
    const TileLayout& layout = tile_layout();
    const Saturation s{layout, tile.tile.depth, tile.tile.deviation, tile.tile.radius, tile.rounded, tile.exists};
    const unsigned first = 1u << level;
    const bool above_tiles = tile.inner() && level == tile_levels - 1;
    for (unsigned i = first; i < 2 * first; ++i) {
        s.raise(i);
        if (above_tiles) raise_over_tiles(tiles, tile, i);
    }
    for (unsigned i = first; i < 2 * first; ++i) {
        const unsigned beyond = layout.split_neighbor[i];
        if (i < beyond) s.join(i, beyond);
    }
    if (!tile.inner()) return;
    for (unsigned i = first; i < 2 * first; ++i) {
        s.deviation[i] = up_the_deviations(s.deviation[i]);
        if (above_tiles) s.radius[i] = up_the_radii(s.radius[i]);
    }
}

// Each pair of side cells is settled once, by the tile that comes first.
void settle_sides(std::span<BakedTile> tiles, std::size_t t, int level) {
    BakedTile& tile = tiles[t];
    const auto sides = side_cells(tile.tile.depth);
    for (std::size_t k = 0; k < sides.size(); ++k) {
        const unsigned i = sides[k].cell;
        if (relative_level(i) != level || !tile.exists[i]) continue;
        const auto [beside, j] = across(tile, sides[k]);
        if (static_cast<std::size_t>(beside) < t) continue;
        BakedTile& other = tiles[static_cast<std::size_t>(beside)];
        const auto other_sides = side_cells(other.tile.depth);
        const auto at =
            std::partition_point(other_sides.begin(), other_sides.end(), [j = j](SideCell s) { return s.cell < j; });
        SideGain& gain = tile.gain[k];
        SideGain& other_gain = other.gain[static_cast<std::size_t>(at - other_sides.begin())];
        const auto settle_pair = [](float& a, float& b, std::uint16_t& gain_a, std::uint16_t& gain_b, auto code,
                                    auto value) {
            const unsigned code_a = code(a), code_b = code(b), larger = std::max(code_a, code_b);
            gain_a = static_cast<std::uint16_t>(larger - code_a);
            gain_b = static_cast<std::uint16_t>(larger - code_b);
            a = b = value(larger);
        };
        settle_pair(tile.tile.deviation[i], other.tile.deviation[j], gain.deviation, other_gain.deviation,
                    deviation_code, deviation_from_code);
        settle_pair(tile.tile.radius[i], other.tile.radius[j], gain.radius, other_gain.radius, radius_code,
                    radius_from_code);
    }
}

// What a tile knows of those below it.
void note_children(std::span<const BakedTile> tiles, BakedTile& tile) {
    tile.tile.child_deviation.assign(tile_cells, 0);
    tile.tile.child_radius.assign(tile_cells, 0);
    for (std::size_t k = 0; k < tile_cells; ++k) {
        if (tile.below[k] < 0) continue;
        const BakedTile& below = tiles[static_cast<std::size_t>(tile.below[k])];
        if (!below.exists[1]) continue;
        tile.tile.child_deviation[k] = below.tile.deviation[1];
        tile.tile.child_radius[k] = below.tile.radius[1];
    }
}

}  // namespace

void settle(std::span<BakedTile> tiles) {
    for (BakedTile& t : tiles) t.gain.assign(side_cells(t.tile.depth).size(), {});
    for (std::size_t end = tiles.size(); end > 0;) {
        const int root_level = tiles[end - 1].tile.root.bisection_level();
        std::size_t begin = end;
        while (begin > 0 && tiles[begin - 1].tile.root.bisection_level() == root_level) --begin;
        for (int level = tile_levels - 1; level >= 0; --level) {
            for (std::size_t t = begin; t < end; ++t)
                if (level < tiles[t].tile.depth) settle_inside(tiles, tiles[t], level);
            for (std::size_t t = begin; t < end; ++t)
                if (level < tiles[t].tile.depth) settle_sides(tiles, t, level);
        }
        end = begin;
    }
    for (BakedTile& t : tiles)
        if (t.inner()) note_children(tiles, t);
}

}  // namespace planet
