#include "planet/streaming/resident_set.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "planet/parallel.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

constexpr Side sides[] = {Side::split, Side::left_leg, Side::right_leg};

std::size_t measured_bytes(const ResidentTile& tile) {
    return tile.tile->bytes() + (tile.support.size() + tile.below.size()) * sizeof(ResidentTile*);
}

/// A record that passes every test that splits a cell of the tile at this depth or deeper. All split vertices lie in the
/// ball of the root; metres are added for the roundings of its record and theirs.
SplitRecord deeper_than(const PlacedTile& tile, int depth) {
    constexpr float rounding_m = 4;
    if (depth >= tile.depth || !tile.is_stored(1)) return {};
    SplitRecord record = tile.split[1];
    const auto [deviation, radius] = tile.most[static_cast<std::size_t>(depth)];
    record.deviation = deviation;
    record.radius += radius + rounding_m;
    return record;
}

}  // namespace

const PlacedTile* ResidentSet::tile(LocationCode root) const {
    const auto found = tiles_.find(root.bits());
    return found == tiles_.end() ? nullptr : found->second.tile.get();
}

ResidentTile* ResidentSet::find(LocationCode root) {
    const auto found = tiles_.find(root.bits());
    return found == tiles_.end() || !found->second.tile ? nullptr : &found->second;
}

std::vector<ResidentTile*> ResidentSet::all() {
    std::vector<ResidentTile*> list;
    list.reserve(size_);
    for (auto& [code, tile] : tiles_)
        if (tile.tile) list.push_back(&tile);
    return list;
}

ResidentTile& ResidentSet::slot(LocationCode root) {
    const auto [at, added] = tiles_.try_emplace(root.bits());
    if (added) {
        at->second.root = root;
        bytes_ += sizeof(ResidentTile);
    }
    return at->second;
}

// Not before what is unsettled, which may name them, is settled.
void ResidentSet::free_unused() {
    for (const LocationCode root : unused_) {
        const auto found = tiles_.find(root.bits());
        if (found == tiles_.end() || found->second.tile || found->second.supported > 0) continue;
        bytes_ -= sizeof(ResidentTile);
        tiles_.erase(found);
    }
    unused_.clear();
}

ResidentTile& ResidentSet::insert(std::unique_ptr<PlacedTile> tile, std::span<const LocationCode> support) {
    ResidentTile& resident = slot(tile->root);
    assert(!resident.tile && resident.open_depth == 0);
    resident.below.assign(tile->child_bound.size(), nullptr);
    resident.tile = std::move(tile);
    resident.unopened = deeper_than(*resident.tile, 0);
    resident.fresh = true;
    marked_.push_back(resident.root);
    tie(resident, support);
    ++size_;
    bytes_ += resident.bytes = measured_bytes(resident);
    changes_.push_back(resident.root);
    return resident;
}

void ResidentSet::tie(ResidentTile& tile, std::span<const LocationCode> support) {
    const LocationCode root = tile.root;
    if (root.bisection_level() > 0) {
        tile.above = find(layers_.above(root));
        assert(tile.above);
        const unsigned position = layers_.position(root);
        tile.above->tile->set_child(position, tile.tile.get());
        tile.above->below[tile.above->tile->child_bound.index(position)] = &tile;
        ++tile.above->children;
    }
    for (const Side side : sides) {
        ResidentTile* const beside = find(neighbor(root, side));
        tile.beside[static_cast<std::size_t>(side)] = beside;
        for (const Side back : sides)
            if (beside && neighbor(beside->root, back) == root) beside->beside[static_cast<std::size_t>(back)] = &tile;
    }
    tile.support.reserve(support.size());
    for (const LocationCode other : support) {
        tile.support.push_back(&slot(other));
        ++tile.support.back()->supported;
    }
}

void ResidentSet::untie(ResidentTile& tile) {
    for (ResidentTile* const beside : tile.beside)
        if (beside)
            std::replace(beside->beside.begin(), beside->beside.end(), &tile, static_cast<ResidentTile*>(nullptr));
    if (tile.above) {
        const unsigned position = layers_.position(tile.root);
        tile.above->tile->set_child(position, nullptr);
        tile.above->below[tile.above->tile->child_bound.index(position)] = nullptr;
        --tile.above->children;
    }
    for (ResidentTile* const support : std::exchange(tile.support, {})) {
        if (--support->supported == 0) unused_.push_back(support->root);
    }
    tile.above = nullptr;
    tile.beside = {};
}

void ResidentSet::erase(LocationCode root) {
    ResidentTile& tile = *find(root);
    assert(tile.children == 0);
    for (const SideCell& s : side_cells(tile.open_depth)) {
        ResidentTile* const beside = tile.beside[static_cast<std::size_t>(s.side)];
        if (beside && tile.tile->is_open(s.cell)) set_open(*beside, local_across(s.cell), false);
    }
    tile.open_depth = 0;
    --size_;
    bytes_ -= std::exchange(tile.bytes, 0);
    untie(tile);
    tile.tile.reset();
    tile.changed.reset();
    tile.below = {};
    unused_.push_back(root);
    changes_.push_back(root);
}

void ResidentSet::open(ResidentTile& tile, int depth) {
    const int from = std::exchange(tile.open_depth, std::min(std::max(tile.open_depth, depth), tile.tile->depth));
    if (from == tile.open_depth) return;
    tile.unopened = deeper_than(*tile.tile, tile.open_depth);
    // What lies below these follows where they open.
    for (unsigned i = 1u << from; i < 2u << from; ++i)
        if (from == 0 || tile.tile->is_open(i >> 1)) unsettle(tile, i);
}

// The cells of a tile that is opened further are made anew: not at every step of the eye.
void ResidentSet::open_for(ResidentTile& tile, const SplitTest& test) {
    constexpr int levels_ahead = 2;
    if (!test(tile.unopened)) return;
    int depth = tile.open_depth + 1;
    while (depth < tile.tile->depth && test(deeper_than(*tile.tile, depth))) ++depth;
    open(tile, depth + levels_ahead);
}

void ResidentSet::unsettle(ResidentTile& tile, unsigned local) {
    unsettled_[static_cast<std::size_t>(tile.root.bisection_level() + relative_level(local))].push_back({&tile, local});
}

void ResidentSet::unsettle_children(ResidentTile& tile, unsigned local) {
    const unsigned first = 2 * local;
    if (!(first >> tile.open_depth)) {
        unsettle(tile, first);
        unsettle(tile, first + 1);
    } else if (first >> tile.tile->depth && tile.children > 0) {
        const unsigned position = tile.tile->position_below(first);
        for (const unsigned k : {position, position + 1})
            if (tile.tile->child_bound.has(k))
                if (ResidentTile* const below = tile.below[tile.tile->child_bound.index(k)]; below && below->open_depth)
                    unsettle(*below, 1);
    }
}

void ResidentSet::settle() {
    for (std::vector<Unsettled>& level : unsettled_) {
        for (const auto [tile, local] : level)
            if (!(local >> tile->open_depth)) settle(*tile, local);
        level.clear();
    }
    free_unused();
}

void ResidentSet::settle(ResidentTile& tile, unsigned local) {
    const PlacedTile& placed = *tile.tile;
    const unsigned beyond = tile_layout().split_neighbor[local];
    if (beyond == 0) return settle_side(tile, local, tile.beside[static_cast<std::size_t>(side_of(local))]);
    const bool open = placed.is_stored(local) && placed.is_open(local >> 1) && placed.is_open(beyond >> 1);
    if (open == placed.is_open(local)) return;
    set_open(tile, local, open);
    change(tile, beyond);
    unsettle_children(tile, beyond);
}

// Whether the tile has the cell's record and the diamond of the cell's parent exists.
bool ResidentSet::may_open(const ResidentTile& tile, unsigned local) const {
    if (local >> tile.open_depth || !tile.tile->is_stored(local)) return false;
    if (local > 1) return tile.tile->is_open(local >> 1);
    return !tile.above || tile.above->tile->is_open(layers_.local_above(tile.root) >> 1);
}

void ResidentSet::settle_side(ResidentTile& tile, unsigned local, ResidentTile* beside) {
    const unsigned beyond = local_across(local);
    const bool open = beside && may_open(tile, local) && may_open(*beside, beyond);
    if (open == tile.tile->is_open(local)) return;
    set_open(tile, local, open);
    if (beside) set_open(*beside, beyond, open);
}

void ResidentSet::set_open(ResidentTile& tile, unsigned local, bool open) {
    tile.tile->set_open(local, open);
    change(tile, local);
    unsettle_children(tile, local);
}

// Levels change from the coarsest down, and below a cell that has changed usually all do: they need no mention.
void ResidentSet::change(ResidentTile& tile, unsigned local) {
    if (tile.fresh) return;
    if (!tile.changed) {
        tile.changed = std::make_unique<std::bitset<1u << tile_levels>>();
        marked_.push_back(tile.root);
    }
    for (unsigned i = local; i > 0; i >>= 1)
        if (tile.changed->test(i)) return;
    tile.changed->set(local);
    changes_.push_back(cell_code(tile.root, local));
}

std::vector<LocationCode> ResidentSet::take_changes() {
    // Thousands a frame where tiles come and go: sorted by keys made once. Of cells that begin at the same place the
    // coarser has the lesser code.
    std::vector<std::pair<std::uint64_t, LocationCode>> sorted;
    sorted.reserve(changes_.size());
    for (const LocationCode cell : changes_) sorted.emplace_back(cell.first_at(max_bisection_level), cell);
    std::sort(sorted.begin(), sorted.end());
    std::vector<LocationCode> outermost;
    for (const auto& [begin, cell] : sorted)
        if (outermost.empty() || !outermost.back().contains(cell)) outermost.push_back(cell);
    for (const LocationCode root : marked_)
        if (ResidentTile* const tile = find(root)) {
            tile->fresh = false;
            tile->changed.reset();
        }
    marked_.clear();
    changes_.clear();
    return outermost;
}

void ResidentSet::place(const Placement& placement, unsigned threads) {
    const std::vector<ResidentTile*> tiles = all();
    parallel_for(tiles.size(), threads, [&](std::size_t i) {
        tiles[i]->tile = std::make_unique<PlacedTile>(*tiles[i]->tile, placement);
        tiles[i]->tile->set_no_children();
    });
    bytes_ = 0;
    for (ResidentTile* const t : tiles) {
        bytes_ += t->bytes = measured_bytes(*t);
        t->unopened = deeper_than(*t->tile, t->open_depth);
        if (t->above)
            t->above->tile->set_child(layers_.position(t->root), t->tile.get());
        else
            changes_.push_back(t->root);
    }
}

std::vector<LocationCode> tile_support(LocationCode root, int depth) {
    std::vector<LocationCode> support;
    // Diamonds inside the tile depend, within it, on those of its sides. What these depend on, from the finest level up.
    const auto side = side_cells(depth);
    std::size_t next_side = side.size();
    std::vector<LocationCode> diamonds, above;
    for (int level = depth - 1; level >= 0; --level) {
        for (; next_side > 0 && side[next_side - 1].cell >= 1u << level; --next_side)
            diamonds.push_back(diamond(cell_code(root, side[next_side - 1].cell)));
        std::sort(diamonds.begin(), diamonds.end());
        diamonds.erase(std::unique(diamonds.begin(), diamonds.end()), diamonds.end());
        above.clear();
        for (const LocationCode cell : diamonds)
            for (const LocationCode half : {cell, neighbor(cell)}) {
                const LocationCode holder = half.ancestor(root.bisection_level());
                if (holder == root) continue;
                if (std::find(support.begin(), support.end(), holder) == support.end()) support.push_back(holder);
                if (level > 0) above.push_back(diamond(half.parent()));
            }
        std::swap(diamonds, above);
    }
    return support;
}

}  // namespace planet
