#include "planet/bake/tiles.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "planet/error.h"
#include "planet/store/ladder.h"

namespace planet {

void raise_to(float& value, float least) {
    const std::atomic_ref<float> shared(value);
    float now = shared.load(std::memory_order_relaxed);
    while (now < least && !shared.compare_exchange_weak(now, least, std::memory_order_relaxed)) {
    }
}

void report_above(const FrontierTile& tile, float min_height, float max_height) {
    InnerTile& above = *tile.above;
    above.changed = true;
    above.tile.min_height = std::min(above.tile.min_height, min_height);
    above.tile.max_height = std::max(above.tile.max_height, max_height);
    const SideSteps steps = tile.steps(0);  // the root's split side is the first of the side cells
    if (steps.deviation == 0) return;       // does not exist
    const unsigned end = 1u << above.tile.depth;
    const unsigned place = static_cast<unsigned>(tile.root.bits()) & (end - 1);
    const float deviation = deviation_from_code(steps.deviation), radius = radius_from_code(steps.radius);
    above.tile.child_deviation[place] = deviation;
    above.tile.child_radius[place] = radius;
    const unsigned parent = (end | place) >> 1;
    if (!above.exists[parent]) return;
    const std::size_t v = tile_layout().split_vertex[parent];
    TileRecords& records = *above.records;
    raise_to(records.deviation[v], deviation);
    records.radius[v] =
        std::max(records.radius[v], certified_radius(radius_over(records.position[v], tile.split_position, radius)));
}

template <class Work>
void TileMaker::timed(BakeStep step, Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    seconds_[static_cast<std::size_t>(step)] +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::unique_ptr<InnerTile> TileMaker::open(LocationCode root, InnerTile* above) {
    auto inner = std::make_unique<InnerTile>();
    Tile& tile = inner->tile;
    tile.root = root;
    tile.depth = scene_.plan.layers().depth(root.bisection_level());
    const std::size_t cells = std::size_t{1} << tile.depth;
    inner->above = above;
    inner->records = std::make_unique<TileRecords>();
    exists_.resize(cells);
    existence_.of_tile(root, exists_);
    inner->exists = exists_;
    timed(BakeStep::resampling, [&] { sample(tile, above); });
    timed(BakeStep::deviation, [&] {
        lattice_.set_positions(scene_.scale.placement, tile.height, tile.undulation, exists_);
        find_lacks_below(root, tile.depth);
        set_own(*inner->records, true);
        own_height_range(tile, exists_);
        measure_above();
    });
    std::vector<std::uint8_t> has_tile_below(cells);
    for (const LocationCode below : scene_.plan.below(root)) {
        const std::size_t place = below.bits() & (cells - 1);
        tile.child_exists.set(place);
        has_tile_below[place] = existence_(below);
    }
    timed(BakeStep::certifying, [&] {
        tile.resampling =
            resampling_.largest({scene_.field, scene_.scale.placement, tile, lattice_, exists_}, has_tile_below);
    });
    tile.deviation.assign(exists_.begin(), exists_.end());
    tile.child_deviation.assign(cells, 0);
    tile.child_radius.assign(cells, 0);
    return inner;
}

std::unique_ptr<FrontierTile> TileMaker::measure(LocationCode root, InnerTile* above, std::vector<SideSteps> theirs,
                                                 std::unique_ptr<TileRecords> records) {
    tile_.root = root;
    tile_.depth = scene_.plan.depth(root);
    exists_.resize(std::size_t{1} << tile_.depth);
    existence_.of_tile(root, exists_);
    std::unique_ptr<FrontierTile> tile = frontier_tile(root, tile_.depth, above, std::move(theirs));
    timed(BakeStep::resampling, [&] { sample(tile_, above); });
    timed(BakeStep::deviation, [&] {
        lattice_.set_positions(scene_.scale.placement, tile_.height, tile_.undulation, exists_);
        set_own(*records, false);
        measure_above();
    });
    timed(BakeStep::settling, [&] { records->settle(tile->theirs, tile->mine); });
    timed(BakeStep::certifying, [&] {
        tile->resampling = resampling_.largest({scene_.field, scene_.scale.placement, tile_, lattice_, exists_}, {});
    });
    tile->height = PackedHeights(tile_.height, scene_.scale.quantum_m);
    tile->origins = std::move(tile_.origins);
    const std::size_t own = std::max<std::size_t>(3, own_undulations(root, tile_.depth));
    if (scene_.scale.has_undulation) tile->undulation.reserve(own);
    for (std::size_t v = 0; scene_.scale.has_undulation && v < own; ++v)
        tile->undulation.push_back(static_cast<float>(tile_.undulation[v].m));
    tile->split_position = records->position[3];
    tile->records = std::move(records);
    return tile;
}

std::unique_ptr<FrontierTile> TileMaker::enter_frontier(std::unique_ptr<InnerTile> inner,
                                                        std::vector<SideSteps> theirs) {
    std::unique_ptr<FrontierTile> tile =
        frontier_tile(inner->tile.root, inner->tile.depth, inner->above, std::move(theirs));
    tile->records = std::move(inner->records);
    tile->split_position = tile->records->position[3];
    tile->inner = std::move(inner);
    timed(BakeStep::settling, [&] { tile->records->settle(tile->theirs, tile->mine); });
    return tile;
}

void TileMaker::settle(FrontierTile& tile, std::span<const SideSteps> theirs, std::unique_ptr<TileRecords> records) {
    if (tile.records) return timed(BakeStep::settling, [&] { tile.records->rise(theirs, tile.mine); });
    timed(BakeStep::deviation, [&] {
        restore(tile);
        lattice_.set_normals(corners(tile.root), tile.depth);
        lattice_.set_positions(scene_.scale.placement, tile_.height, tile_.undulation, exists_);
        set_own(*records, false);
    });
    timed(BakeStep::settling, [&] { records->settle(theirs, tile.mine); });
    tile.records = std::move(records);
}

std::vector<std::uint8_t> TileMaker::encode(FrontierTile& tile) {
    if (tile.inner) {
        const TileLayout& layout = tile_layout();
        baked_.tile = std::move(tile.inner->tile);
        baked_.exists = std::move(tile.inner->exists);
        baked_.tile.radius.resize(baked_.tile.deviation.size());
        for (std::size_t i = 1; i < baked_.tile.deviation.size(); ++i) {
            baked_.tile.deviation[i] = tile.records->deviation[layout.split_vertex[i]];
            baked_.tile.radius[i] = tile.records->radius[layout.split_vertex[i]];
        }
    } else {
        restore(tile);
        own_height_range(tile_, exists_);
        std::swap(baked_.tile, tile_);
        baked_.exists.assign(exists_.begin(), exists_.end());
        baked_.gain.resize(tile.mine.size());
        for (std::size_t k = 0; k < tile.mine.size(); ++k) {
            const SideSteps settled = tile.steps(k);
            baked_.gain[k] = {static_cast<std::uint16_t>(settled.deviation - tile.mine[k].deviation),
                              static_cast<std::uint16_t>(settled.radius - tile.mine[k].radius)};
        }
    }
    baked_.has_tiles_below = tile.inner != nullptr;
    std::vector<std::uint8_t> bytes;
    timed(BakeStep::compression, [&] { bytes = encode_tile(baked_, scene_.scale); });
    return bytes;
}

std::unique_ptr<FrontierTile> TileMaker::frontier_tile(LocationCode root, int depth, InnerTile* above,
                                                       std::vector<SideSteps> theirs) {
    auto tile = std::make_unique<FrontierTile>();
    tile->root = root;
    tile->depth = depth;
    tile->above = above;
    tile->mine.resize(side_cells(depth).size());
    tile->theirs = std::move(theirs);
    tile->theirs.resize(tile->mine.size());
    return tile;
}

// Heights, undulations and existence of a leaf tile of the frontier, as they were measured.
void TileMaker::restore(const FrontierTile& tile) {
    tile_.root = tile.root;
    tile_.depth = tile.depth;
    tile_.resampling = tile.resampling;
    tile.height.unpack(tile_.height);
    tile_.origins = tile.origins;
    tile_.child_exists.reset();
    exists_.resize(std::size_t{1} << tile.depth);
    existence_.of_tile(tile.root, exists_);
    if (!scene_.scale.has_undulation) return;
    tile_.undulation.resize(tile.height.size());
    for (std::size_t v = 0; v < tile.undulation.size(); ++v)
        tile_.undulation[v].m = static_cast<double>(tile.undulation[v]);
    interpolate_undulations(tile.root, tile.depth, tile_.undulation);
}

// The corners of a tile below the last of above_.
Corners TileMaker::root_corners(LocationCode root) const {
    if (above_.empty()) return face_corners(root.face());
    const Corners& up = above_.back().corners;
    return child_corners(up, split_vertex(up), root.child_index());
}

// Normals, heights, where they are from, undulations. The root's corners are vertices of the tile above: taken from there.
void TileMaker::sample(Tile& tile, InnerTile* above) {
    find_cells_above(tile.root, above);
    lattice_.set_normals(root_corners(tile.root), tile.depth);
    normals_.resize(lattice_.size());
    for (std::size_t v = 0; v < normals_.size(); ++v) normals_[v] = lattice_.normal(v);
    tile.height.resize(normals_.size());
    origins_.assign(normals_.size(), {});
    if (scene_.scale.files > 0)
        scene_.field.heights_with_origins(normals_, tile.height, origins_);
    else
        scene_.field.heights(normals_, tile.height);
    quantize(tile.height);
    if (above) {
        const auto& corner = tile_layout().corners[scene_.plan.layers().local_above(tile.root)];
        for (std::size_t v = 0; v < 3; ++v) {
            tile.height[v] = above->tile.height[corner[v]];
            origins_[v].origin = above->tile.origins[corner[v]];
        }
    }
    tile.origins = OriginPlane(origins_);
    if (scene_.scale.has_undulation) sample_undulations(tile, above);
}

// To whole quanta; NaN is 0, of no source.
void TileMaker::quantize(std::span<float> heights) {
    const double quantum = scene_.scale.quantum_m, limit = static_cast<double>(largest_height_quanta);
    bool fits = true, answered = true;
    for (float& height : heights) {
        const double quanta = std::nearbyint(static_cast<double>(height) / quantum);
        fits &= !(std::abs(quanta) > limit);
        answered &= quanta == quanta;
        height = static_cast<float>(quanta * quantum);
    }
    for (std::size_t v = 0; v < heights.size() && !answered; ++v)
        if (std::isnan(heights[v])) {
            heights[v] = 0;
            origins_[v] = {};
        }
    if (!fits) refuse_heights(heights);
}

void TileMaker::refuse_heights(std::span<const float> heights) const {
    const double limit = static_cast<double>(largest_height_quanta) * scene_.scale.quantum_m;
    const auto too_high = [&](float h) { return std::abs(static_cast<double>(h)) > limit; };
    const auto v = std::find_if(heights.begin(), heights.end(), too_high);
    const Geodetic g = geodetic_from_normal(normals_[static_cast<std::size_t>(v - heights.begin())]);
    throw Error(Fault::bad_data, "bake",
                "the height at " + std::to_string(g.latitude / degrees) + "," + std::to_string(g.longitude / degrees) +
                    " is " + std::to_string(*v) + " m",
                "at most " + std::to_string(limit) + " m up or down");
}

void TileMaker::sample_undulations(Tile& tile, const InnerTile* above) {
    tile.undulation.resize(tile.height.size());
    const std::size_t own = own_undulations(tile.root, tile.depth);
    undulations_.resize(own);
    scene_.options.undulation(std::span(normals_).first(own), undulations_);
    for (std::size_t v = 0; v < own; ++v) {
        const double N = std::nearbyint(undulations_[v].m / undulation_quantum_m) * undulation_quantum_m;
        if (!(std::abs(N) < 1e4))
            throw Error(Fault::bad_data, "bake", "the geoid's height is " + std::to_string(undulations_[v].m) + " m",
                        "-10000 to 10000 m");
        tile.undulation[v].m = N;
    }
    if (above) {
        const auto& corner = tile_layout().corners[scene_.plan.layers().local_above(tile.root)];
        for (std::size_t v = 0; v < 3; ++v) tile.undulation[v] = above->tile.undulation[corner[v]];
    }
    interpolate_undulations(tile.root, tile.depth, tile.undulation);
}

void TileMaker::find_lacks_below(LocationCode root, int depth) {
    const auto exists_below = [&](unsigned local) {
        const LocationCode below = cell_code(root, local);
        return scene_.plan.contains(below) && existence_(below);
    };
    const unsigned cells = 1u << depth;
    lacks_below_.resize(cells / 2);
    for (unsigned k = 0; k < cells / 2; ++k)
        lacks_below_[k] = !(exists_below(cells + 2 * k) && exists_below(cells + 2 * k + 1));
}

// The tile's own deviations and where its radii start, from lattice_ and exists_.
void TileMaker::set_own(TileRecords& records, bool inner) {
    deviation_.resize(exists_.size());
    radius_.resize(exists_.size());
    if (inner) {
        own_deviation(lattice_, deviation_);
        corner_radii(lattice_, exists_, true, lacks_below_, radius_);
    } else {
        measure_leaf(lattice_, exists_, deviation_, radius_);
    }
    records.depth = lattice_.depth();
    records.inner = inner;
    std::copy(lattice_.rounded().begin(), lattice_.rounded().end(), records.position.begin());
    records.set_own(deviation_, radius_, exists_);
}

// This tile's vertices against every cell that holds its root.
void TileMaker::measure_above() {
    const TileHull hull(lattice_);
    for (const CellAbove& cell : above_) {
        if (!cell.exists) continue;
        float& deviation = cell.holder->records->deviation[cell.vertex];
        const float known = std::atomic_ref(deviation).load(std::memory_order_relaxed);
        if (!hull.may_exceed(cell.plane, known)) continue;
        raise_to(deviation, certified_deviation(deviation_from(lattice_, cell.plane)));
        cell.holder->changed = true;
    }
}

// Most are those of the last tile.
void TileMaker::find_cells_above(LocationCode root, InnerTile* above) {
    const int levels = root.bisection_level();
    std::size_t same = 0;
    while (same < above_.size() && static_cast<int>(same) < levels &&
           above_[same].cell == root.ancestor(static_cast<int>(same)))
        ++same;
    above_.erase(above_.begin() + static_cast<std::ptrdiff_t>(same), above_.end());
    const TileLayers layers = scene_.plan.layers();
    std::vector<InnerTile*> holders;
    for (InnerTile* holder = above; holder; holder = holder->above) holders.push_back(holder);
    for (int level = static_cast<int>(same); level < levels; ++level) {
        Corners c = face_corners(root.face());
        if (level > 0) {
            const Corners& up = above_.back().corners;
            c = child_corners(up, split_vertex(up), static_cast<int>(root.bits() >> (levels - level) & 1));
        }
        InnerTile* holder = holders[holders.size() - 1 - layers.layer(level)];
        const unsigned local = cell_in_tile(root.ancestor(level), layers).local;
        const auto& vertex = tile_layout().corners[local];
        const auto at = [&](std::size_t k, const glm::dvec3& n) {
            const std::size_t v = vertex[k];
            const GeoidUndulation N = scene_.scale.has_undulation ? holder->tile.undulation[v] : GeoidUndulation{};
            return scene_.scale.placement.ecef(n, static_cast<double>(holder->tile.height[v]), N);
        };
        above_.push_back({root.ancestor(level),
                          c,
                          {at(0, c.left), at(1, c.right), at(2, c.apex)},
                          holder,
                          tile_layout().split_vertex[local],
                          holder->exists[local] != 0});
    }
}

}  // namespace planet
