#pragma once
// The pedestrian bake: all tiles in memory, on one thread, level by level. What the streaming one must arrive at.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <unordered_map>

#include "planet/bake/bake.h"
#include "planet/bake/coverage.h"
#include "planet/mesh/deviation.h"
#include "planet/store/baked_tile.h"
#include "planet/store/ladder.h"
#include "planet/store/surface_cursor.h"
#include "planet/store/tile_codec.h"

namespace planet::testing {

/// The records of one tile, a cell at a time. Spans are by local index, but `rounded` by vertex index.
struct Saturation {
    const TileLayout& layout;
    int depth;
    std::span<float> deviation, radius;
    std::span<const glm::vec3> rounded;
    std::span<const std::uint8_t> exists;

    /// Raises record i over the diamonds of its two children in the same tile; 0 if it does not exist.
    void raise(unsigned i) const {
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
    /// Gives both cells of the diamond i inside the tile the larger numbers.
    void join(unsigned i, unsigned beyond) const {
        deviation[i] = deviation[beyond] = std::max(deviation[i], deviation[beyond]);
        radius[i] = radius[beyond] = std::max(radius[i], radius[beyond]);
    }
};

struct LinkedTile {
    Tile tile;
    std::vector<glm::vec3> rounded;
    std::vector<std::uint8_t> exists;
    std::array<std::int32_t, 3> beside;
    std::int32_t above = -1;
    unsigned local_above = 0;
    std::vector<std::int32_t> below;
    bool inner() const { return !below.empty(); }
};

using TileIndex = std::unordered_map<std::uint64_t, std::int32_t>;

inline std::int32_t find(const TileIndex& index, LocationCode root) {
    const auto found = index.find(root.bits());
    return found == index.end() ? -1 : found->second;
}

inline void tie_tile(std::vector<LinkedTile>& tiles, const TileIndex& index, TileLayers layers, std::size_t t) {
    LinkedTile& tile = tiles[t];
    const LocationCode root = tile.tile.root;
    for (const Side side : {Side::split, Side::left_leg, Side::right_leg})
        tile.beside[static_cast<std::size_t>(side)] = find(index, neighbor(root, side));
    if (root.bisection_level() == 0) return;
    tile.above = find(index, layers.above(root));
    tile.local_above = layers.local_above(root);
    assert(tile.above >= 0);
    LinkedTile& parent = tiles[static_cast<std::size_t>(tile.above)];
    const unsigned position = layers.position(root);
    parent.below.resize(std::size_t{1} << parent.tile.depth, -1);
    parent.below[position] = static_cast<std::int32_t>(t);
    parent.tile.child_exists.set(position);
}

// Whether cell i's record is there and the diamond of its parent exists.
inline bool may_exist(const std::vector<LinkedTile>& tiles, const LinkedTile& tile, unsigned i) {
    if (i >> tile.tile.depth) return false;
    if (i > 1) return tile.exists[i >> 1];
    if (tile.above < 0) return true;
    return tiles[static_cast<std::size_t>(tile.above)].exists[tile.local_above >> 1];
}

// The other tile of a side cell, if it is there, and the cell's local index in it.
inline std::pair<std::int32_t, unsigned> across(const LinkedTile& tile, SideCell s) {
    return {tile.beside[static_cast<std::size_t>(s.side)], local_across(s.cell)};
}

inline void find_existence(std::vector<LinkedTile>& tiles, LinkedTile& tile, int level) {
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

inline std::vector<LinkedTile> tie_tiles(const TilePlan& planned, const std::vector<LocationCode>& plan) {
    std::vector<LinkedTile> tiles(plan.size());
    TileIndex index;
    index.reserve(plan.size());
    for (std::size_t t = 0; t < plan.size(); ++t) {
        tiles[t].tile.root = plan[t];
        tiles[t].tile.depth = planned.depth(plan[t]);
        tiles[t].exists.assign(std::size_t{1} << planned.depth(plan[t]), 0);
        index.emplace(plan[t].bits(), static_cast<std::int32_t>(t));
    }
    for (std::size_t t = 0; t < tiles.size(); ++t) tie_tile(tiles, index, planned.layers(), t);
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

// Raises a cell of an inner tile's last level over the diamonds of the tiles below it.
inline void raise_over_tiles(std::span<LinkedTile> tiles, LinkedTile& tile, unsigned i) {
    if (!tile.exists[i]) return;
    const glm::vec3& m = tile.rounded[tile_layout().split_vertex[i]];
    double reach = 0;
    for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
        const std::int32_t below = tile.below[child - (1u << tile.tile.depth)];
        if (below < 0) continue;
        const LinkedTile& b = tiles[static_cast<std::size_t>(below)];
        if (!b.exists[1]) continue;
        tile.tile.deviation[i] = std::max(tile.tile.deviation[i], b.tile.deviation[1]);
        reach = std::max(reach, radius_over(m, b.rounded[tile_layout().split_vertex[1]], b.tile.radius[1]));
    }
    tile.tile.radius[i] = std::max(tile.tile.radius[i], certified_radius(reach));
}

inline float up_the_deviations(float deviation) {
    return deviation_from_code(deviation_code(deviation));
}
inline float up_the_radii(float radius) {
    return radius_from_code(radius_code(radius));
}

inline void settle_inside(std::span<LinkedTile> tiles, LinkedTile& tile, int level) {
    const TileLayout& layout = tile_layout();
    const Saturation s{layout, tile.tile.depth, tile.tile.deviation, tile.tile.radius, tile.rounded, tile.exists};
    const unsigned first = 1u << level;
    const bool above_tiles = tile.inner() && level == tile.tile.depth - 1;
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
inline void settle_sides(std::span<LinkedTile> tiles, std::size_t t, int level) {
    LinkedTile& tile = tiles[t];
    for (const SideCell& s : side_cells(tile.tile.depth)) {
        const unsigned i = s.cell;
        if (relative_level(i) != level || !tile.exists[i]) continue;
        const auto [beside, j] = across(tile, s);
        if (static_cast<std::size_t>(beside) < t) continue;
        Tile &a = tile.tile, &b = tiles[static_cast<std::size_t>(beside)].tile;
        a.deviation[i] = b.deviation[j] = up_the_deviations(std::max(a.deviation[i], b.deviation[j]));
        a.radius[i] = b.radius[j] = up_the_radii(std::max(a.radius[i], b.radius[j]));
    }
}

// What a tile knows of those below it.
inline void note_children(std::span<const LinkedTile> tiles, LinkedTile& tile) {
    tile.tile.child_deviation.assign(tile.below.size(), 0);
    tile.tile.child_radius.assign(tile.below.size(), 0);
    for (std::size_t k = 0; k < tile.below.size(); ++k) {
        if (tile.below[k] < 0) continue;
        const LinkedTile& below = tiles[static_cast<std::size_t>(tile.below[k])];
        if (!below.exists[1]) continue;
        tile.tile.child_deviation[k] = below.tile.deviation[1];
        tile.tile.child_radius[k] = below.tile.radius[1];
    }
}

inline void settle(std::span<LinkedTile> tiles) {
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
    for (LinkedTile& t : tiles)
        if (t.inner()) note_children(tiles, t);
}

inline std::vector<LocationCode> all_roots(const TilePlan& plan) {
    std::vector<LocationCode> roots;
    for (int face = 0; face < face_count; ++face) roots.push_back(LocationCode::face_root(face));
    for (std::size_t t = 0; t < roots.size(); ++t)
        for (const LocationCode below : plan.below(roots[t])) roots.push_back(below);
    std::sort(roots.begin(), roots.end());
    return roots;
}

class Reader final : public TileReader {
  public:
    explicit Reader(std::span<LinkedTile> tiles) {
        for (LinkedTile& t : tiles) index_.emplace(t.tile.root.bits(), &t.tile);
    }
    std::shared_ptr<const Tile> tile(LocationCode root) const override {
        const auto found = index_.find(root.bits());
        return found == index_.end() ? nullptr : std::shared_ptr<const Tile>(std::shared_ptr<void>(), found->second);
    }
    Tile& at(LocationCode root) const { return *index_.at(root.bits()); }

  private:
    std::unordered_map<std::uint64_t, Tile*> index_;
};

class ReferenceBake {
  public:
    ReferenceBake(const ElevationField& field, const BakeOptions& options, const StoreMetadata& metadata)
        : field_(field), options_(options), placement_{options.ellipsoid, 1.0}, quantum_(metadata.quantum_m) {
        has_undulation_ = !metadata.undulation.empty();
    }

    std::map<LocationCode, Tile> run() {
        const TilePlan plan = coverage(field_, {.mean_radius_m = options_.ellipsoid.mean_radius(),
                                                .least_level = options_.least_level,
                                                .finest_level = options_.finest_level,
                                                .extra_levels = options_.extra_levels,
                                                .first_tile_level = options_.first_tile_level});
        layers_ = plan.layers();
        tiles_ = tie_tiles(plan, all_roots(plan));
        for (LinkedTile& t : tiles_) {
            lattice_.set_normals(corners(t.tile.root), t.tile.depth);
            sample(t);
            measure(t);
        }
        settle(tiles_);
        gather_height_ranges();
        certify();
        std::map<LocationCode, Tile> result;
        for (LinkedTile& t : tiles_) result.emplace(t.tile.root, std::move(t.tile));
        return result;
    }

  private:
    // Heights and undulations. The root's corners are vertices of the tile above: taken from there.
    void sample(LinkedTile& baked) {
        Tile& tile = baked.tile;
        normals_.resize(lattice_.size());
        for (std::size_t v = 0; v < normals_.size(); ++v) normals_[v] = lattice_.normal(v);
        tile.height.resize(normals_.size());
        field_.heights(normals_, tile.height);
        for (std::size_t v = 0; v < tile.height.size(); ++v)
            tile.height[v] =
                std::isnan(tile.height[v])
                    ? 0.0f
                    : static_cast<float>(std::nearbyint(static_cast<double>(tile.height[v]) / quantum_) * quantum_);
        if (has_undulation_) sample_undulations(tile);
        if (baked.above < 0) return;
        const Tile& above = tiles_[static_cast<std::size_t>(baked.above)].tile;
        const auto& corner = tile_layout().corners[baked.local_above];
        for (std::size_t v = 0; v < 3; ++v) {
            tile.height[v] = above.height[corner[v]];
            if (has_undulation_) tile.undulation[v] = above.undulation[corner[v]];
        }
        if (has_undulation_) interpolate_undulations(tile.root, tile.depth, tile.undulation);
    }

    void sample_undulations(Tile& tile) {
        tile.undulation.resize(tile.height.size());
        const std::size_t own = own_undulations(tile.root, tile.depth);
        undulations_.resize(own);
        options_.undulation(std::span(normals_).first(own), undulations_);
        for (std::size_t v = 0; v < own; ++v) {
            const double N = std::nearbyint(undulations_[v].m / undulation_quantum_m) * undulation_quantum_m;
            tile.undulation[v].m = N;
        }
        interpolate_undulations(tile.root, tile.depth, tile.undulation);
    }

    // Own deviations, those of the cells above, and where radii start.
    void measure(LinkedTile& baked) {
        Tile& tile = baked.tile;
        lattice_.set_positions(placement_, tile.height, tile.undulation, baked.exists);
        baked.rounded.assign(lattice_.rounded().begin(), lattice_.rounded().end());
        tile.deviation.resize(baked.exists.size());
        tile.radius.resize(baked.exists.size());
        own_deviation(lattice_, tile.deviation);
        lacks_below_.assign(baked.exists.size() / 2, 1);
        if (baked.inner())
            for (std::size_t k = 0; k < lacks_below_.size(); ++k)
                lacks_below_[k] = !(exists_below(baked, 2 * k) && exists_below(baked, 2 * k + 1));
        corner_radii(lattice_, baked.exists, baked.inner(), lacks_below_, tile.radius);
        own_height_range(tile, baked.exists);
        measure_above(baked);
    }

    bool exists_below(const LinkedTile& baked, std::size_t position) const {
        const std::int32_t below = baked.below[position];
        return below >= 0 && tiles_[static_cast<std::size_t>(below)].exists[1];
    }

    // This tile's vertices against every cell that holds its root.
    void measure_above(const LinkedTile& baked) {
        const LocationCode root = baked.tile.root;
        const int levels = root.bisection_level();
        Corners c = face_corners(root.face());
        above_.clear();
        for (int level = 0; level < levels; ++level) {
            above_.push_back(c);
            c = child_corners(c, split_vertex(c), static_cast<int>(root.bits() >> (levels - 1 - level) & 1));
        }
        std::int32_t holder = baked.above;
        for (int level = levels - 1; level >= 0; --level) {
            const auto [tile_root, local] = cell_in_tile(root.ancestor(level), layers_);
            Tile& tile = tiles_[static_cast<std::size_t>(holder)].tile;
            const float found = certified_deviation(
                deviation_from(lattice_, plane_of(tile, local, above_[static_cast<std::size_t>(level)])));
            tile.deviation[local] = std::max(tile.deviation[local], found);
            if (local == 1) holder = tiles_[static_cast<std::size_t>(holder)].above;
        }
    }

    CellPlane plane_of(const Tile& tile, unsigned local, const Corners& c) const {
        const auto& vertex = tile_layout().corners[local];
        const auto at = [&](std::size_t k, const glm::dvec3& n) {
            const GeoidUndulation N = has_undulation_ ? tile.undulation[vertex[k]] : GeoidUndulation{};
            return placement_.ecef(n, static_cast<double>(tile.height[vertex[k]]), N);
        };
        return {at(0, c.left), at(1, c.right), at(2, c.apex)};
    }

    void gather_height_ranges() {
        for (std::size_t t = tiles_.size(); t-- > 0;) {
            const Tile& tile = tiles_[t].tile;
            if (tiles_[t].above < 0) continue;
            Tile& above = tiles_[static_cast<std::size_t>(tiles_[t].above)].tile;
            above.min_height = std::min(above.min_height, tile.min_height);
            above.max_height = std::max(above.max_height, tile.max_height);
        }
    }

    // Every sample by itself, from its face down.
    void certify() {
        std::vector<glm::dvec3> normals;
        std::vector<float> heights;
        field_.samples({{0, 0, 1}, std::numbers::pi}, normals, heights);
        const Reader reader(tiles_);
        for (std::size_t s = 0; s < normals.size(); ++s) {
            SurfaceCursor cursor(reader, placement_);
            cursor.seek(normals[s]);
            const double off = std::abs(static_cast<double>(heights[s]) - cursor.height(normals[s]));
            float& most = reader.at(cursor.tile().root).resampling;
            most = std::max(most, std::nextafter(static_cast<float>(off), std::numeric_limits<float>::max()));
        }
    }

    const ElevationField& field_;
    const BakeOptions& options_;
    Placement placement_;
    double quantum_;
    bool has_undulation_ = false;
    TileLayers layers_;
    std::vector<LinkedTile> tiles_;
    TileLattice lattice_;
    std::vector<glm::dvec3> normals_;
    std::vector<GeoidUndulation> undulations_;
    std::vector<std::uint8_t> lacks_below_;
    std::vector<Corners> above_;
};

/// The tiles of a store by code. @param metadata of the store that is compared: the quantum
inline std::map<LocationCode, Tile> reference_bake(const ElevationField& field, const BakeOptions& options,
                                                   const StoreMetadata& metadata) {
    return ReferenceBake(field, options, metadata).run();
}

}  // namespace planet::testing
