#include "planet/bake/frontier.h"

#include <algorithm>
#include <cassert>

namespace planet {

namespace {

constexpr std::array all_sides{Side::split, Side::left_leg, Side::right_leg};

constexpr std::size_t index(Side side) {
    return static_cast<std::size_t>(side);
}

// Cells of a level are wound alike: a left leg is the right leg of the cell across it.
constexpr Side seen_from_across(Side side) {
    return side == Side::split ? Side::split : side == Side::left_leg ? Side::right_leg : Side::left_leg;
}

// Crosses `first`, then `second` and so on in turn, until it is back: once around a corner.
void walk(LocationCode from, Side first, Side second, std::vector<LocationCode>& met) {
    LocationCode at = neighbor(from, first);
    for (Side next = second; at != from; next = next == first ? second : first) {
        if (std::find(met.begin(), met.end(), at) == met.end()) met.push_back(at);
        at = neighbor(at, next);
    }
}

const std::vector<std::uint16_t>& side_cells_of(Side side) {
    static const auto lists = [] {
        std::array<std::vector<std::uint16_t>, 3> made;
        const auto sides = side_cells(tile_levels);
        for (std::size_t k = 0; k < sides.size(); ++k)
            made[index(sides[k].side)].push_back(static_cast<std::uint16_t>(k));
        return made;
    }();
    return lists[index(side)];
}

}  // namespace

std::vector<LocationCode> tiles_around(LocationCode root) {
    std::vector<LocationCode> met;
    met.reserve(16);
    // Around the left corner the sides crossed are split, right leg, split, ...: the leg of a cell whose right corner it
    // is. Around the apex every cell has its apex.
    walk(root, Side::split, Side::right_leg, met);
    walk(root, Side::split, Side::left_leg, met);
    walk(root, Side::left_leg, Side::left_leg, met);
    const auto across_apex = [](LocationCode cell) { return neighbor(neighbor(cell, Side::left_leg), Side::left_leg); };
    for (const LocationCode far : {across_apex(neighbor(root)), neighbor(across_apex(root))})
        if (far != root && std::find(met.begin(), met.end(), far) == met.end()) met.push_back(far);
    return met;
}

void Frontier::add(std::unique_ptr<FrontierTile> added) {
    FrontierTile& tile = *added;
    height_bytes_ += tile.height.bytes() + tile.origins.bytes();
    tiles_.emplace(tile.root.bits(), std::move(added));
    meet_around(tile);
    meet_beside(tile);
    keep(tile);
    advance(tile);
}

void Frontier::meet_around(FrontierTile& tile) {
    tile.unsettled_around = 1;
    for (const LocationCode root : tiles_around(tile.root)) {
        if (!plan_.contains(root) || plan_.is_final(root)) continue;
        const auto found = tiles_.find(root.bits());
        if (found == tiles_.end()) {
            ++tile.unsettled_around;
            continue;
        }
        FrontierTile& other = *found->second;
        tile.around[tile.around_count++] = &other;
        other.around[other.around_count++] = &tile;
        tile.unsettled_around += !other.settled;
    }
}

void Frontier::meet_beside(FrontierTile& tile) {
    for (const Side side : all_sides) {
        const LocationCode root = neighbor(tile.root, side);
        const auto found = tiles_.find(root.bits());
        if (found == tiles_.end()) {
            tile.unmeasured_beside += plan_.contains(root) && !plan_.is_final(root);
            continue;
        }
        FrontierTile& other = *found->second;
        tile.beside[index(side)] = &other;
        other.beside[index(seen_from_across(side))] = &tile;
        --other.unmeasured_beside;
        tell(tile, side, other);
        if (!other.busy) tell(other, seen_from_across(side), tile);  // else it will once it is taken back
        advance(other);
    }
}

// What a busy tile arrives at is being written.
void Frontier::tell(const FrontierTile& from, Side side, FrontierTile& to) {
    const auto& across = side_cells_across();
    for (const std::size_t k : side_cells_of(side)) {
        if (k >= from.mine.size()) break;
        const std::size_t j = across[k];
        if (j >= to.theirs.size()) continue;
        const SideSteps said = from.mine[k], known = to.busy ? to.theirs[j] : to.steps(j);
        to.told = to.told || said.deviation > known.deviation || said.radius > known.radius;
        to.theirs[j].deviation = std::max(to.theirs[j].deviation, said.deviation);
        to.theirs[j].radius = std::max(to.theirs[j].radius, said.radius);
    }
}

// What is to be done about a tile after something has happened to it.
void Frontier::advance(FrontierTile& tile) {
    if (tile.busy) return;
    set_settled(tile, !tile.told);
    if (!tile.told || tile.unmeasured_beside > 0) return;
    tile.busy = true;
    to_settle_.push_back(&tile);
}

FrontierTile* Frontier::next_to_settle() {
    if (to_settle_.empty()) return nullptr;
    FrontierTile* tile = to_settle_.front();
    to_settle_.pop_front();
    tile->told = false;
    forget(*tile);
    return tile;
}

void Frontier::settled(FrontierTile& tile) {
    tile.busy = false;
    keep(tile);
    for (const Side side : all_sides) {
        FrontierTile* other = tile.beside[index(side)];
        if (!other) continue;
        tell(tile, side, *other);
        advance(*other);
    }
    advance(tile);
}

void Frontier::set_settled(FrontierTile& tile, bool settled) {
    if (tile.settled == settled) return;
    tile.settled = settled;
    const int change = settled ? -1 : 1;
    std::vector<FrontierTile*> done;
    const auto count = [&](FrontierTile& counting) {
        counting.unsettled_around += change;
        if (counting.unsettled_around == 0) done.push_back(&counting);
    };
    count(tile);
    for (std::size_t n = 0; n < tile.around_count; ++n) count(*tile.around[n]);
    for (FrontierTile* other : done) finish(*other);
}

void Frontier::finish(FrontierTile& tile) {
    assert(tile.settled && !tile.busy && !tile.told);
    forget(tile);
    for (std::size_t n = 0; n < tile.around_count; ++n) {
        FrontierTile& other = *tile.around[n];
        *std::find(other.around.begin(), other.around.end(), &tile) = other.around[--other.around_count];
    }
    for (const Side side : all_sides)
        if (FrontierTile* other = tile.beside[index(side)]) other->beside[index(seen_from_across(side))] = nullptr;
    plan_.mark_final(tile.root);
    const auto found = tiles_.find(tile.root.bits());
    final_.push_back(std::move(found->second));
    tiles_.erase(found);
    height_bytes_ -= tile.height.bytes() + tile.origins.bytes();
    if (!tile.inner) give_back(std::move(tile.records));
}

std::unique_ptr<FrontierTile> Frontier::next_final() {
    if (final_.empty()) return nullptr;
    std::unique_ptr<FrontierTile> tile = std::move(final_.front());
    final_.pop_front();
    return tile;
}

void Frontier::keep(FrontierTile& tile) {
    if (tile.inner) return;
    kept_.push_front(&tile);
    tile.kept = kept_.begin();
    tile.is_kept = true;
}

void Frontier::forget(FrontierTile& tile) {
    if (!tile.is_kept) return;
    kept_.erase(tile.kept);
    tile.is_kept = false;
}

void Frontier::keep_at_most(std::size_t most) {
    while (kept_.size() > most) {
        FrontierTile& last = *kept_.back();
        forget(last);
        give_back(std::move(last.records));
    }
}

std::unique_ptr<TileRecords> Frontier::spare_records() {
    if (spare_.empty()) return std::make_unique<TileRecords>();
    std::unique_ptr<TileRecords> records = std::move(spare_.back());
    spare_.pop_back();
    return records;
}

void Frontier::give_back(std::unique_ptr<TileRecords> records) {
    constexpr std::size_t most_spare = 16;
    if (records && spare_.size() < most_spare) spare_.push_back(std::move(records));
}

}  // namespace planet
