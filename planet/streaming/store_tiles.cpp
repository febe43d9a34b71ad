#include "planet/streaming/store_tiles.h"

namespace planet {

const PlacedTile* StoreTiles::tile(LocationCode root) const {
    Shard& shard = shards_[(root.bits() ^ root.bits() >> tile_levels) % shards_.size()];
    {
        const std::lock_guard lock(shard.mutex);
        const auto found = shard.placed.find(root.bits());
        if (found != shard.placed.end()) return found->second.get();
    }
    // Placed outside the lock; should another thread have been faster, its tile is kept and this one dropped.
    const std::shared_ptr<const Tile> tile = tiles_->tile(root);
    auto placed = tile ? std::make_unique<const PlacedTile>(*tile, placement_) : nullptr;
    const std::size_t bytes = placed ? placed->bytes() : 0;
    const std::lock_guard lock(shard.mutex);
    const auto [at, added] = shard.placed.try_emplace(root.bits(), std::move(placed));
    if (added) tiles_->count_drawn_bytes(static_cast<std::ptrdiff_t>(bytes));
    return at->second.get();
}

StoreTiles::~StoreTiles() {
    tiles_->count_drawn_bytes(-static_cast<std::ptrdiff_t>(bytes()));
}

std::size_t StoreTiles::count() const {
    std::size_t n = 0;
    for (const Shard& s : shards_) {
        const std::lock_guard lock(s.mutex);
        for (const auto& [code, tile] : s.placed) n += tile != nullptr;
    }
    return n;
}

std::size_t StoreTiles::bytes() const {
    std::size_t n = 0;
    for (const Shard& s : shards_) {
        const std::lock_guard lock(s.mutex);
        for (const auto& [code, tile] : s.placed) n += tile ? tile->bytes() : 0;
    }
    return n;
}

}  // namespace planet
