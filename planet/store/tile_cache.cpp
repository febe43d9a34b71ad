#include "planet/store/tile_cache.h"

#include <algorithm>
#include <limits>

#include "planet/error.h"

namespace planet {

std::size_t bytes_of(const Tile& tile) {
    return sizeof(Tile) + sizeof(GeoidUndulation) * tile.undulation.capacity() +
           sizeof(float) * (tile.height.capacity() + tile.deviation.capacity() + tile.radius.capacity());
}

TileCache::TileCache(const ElevationStore& store, std::size_t memory_bytes) : store_(&store), limit_(memory_bytes) {}

std::shared_ptr<const Tile> TileCache::tile(LocationCode root) const {
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = index_.find(root.bits()); found != index_.end()) {
            recent_.splice(recent_.begin(), recent_, found->second);
            return found->second->tile;
        }
    }
    // Read without the lock. Two threads may read the same tile at once: the second one's copy is dropped.
    std::shared_ptr<const Tile> loaded = load(root);
    if (!loaded) return nullptr;
    const std::lock_guard lock(mutex_);
    if (const auto found = index_.find(root.bits()); found != index_.end()) return found->second->tile;
    recent_.push_front({root.bits(), loaded});
    index_.emplace(root.bits(), recent_.begin());
    bytes_ += bytes_of(*loaded);
    while (bytes_ > limit_ && recent_.size() > 1) {
        bytes_ -= bytes_of(*recent_.back().tile);
        index_.erase(recent_.back().code);
        recent_.pop_back();
    }
    return loaded;
}

std::shared_ptr<const Tile> TileCache::load(LocationCode root) const {
    try {
        std::optional<Tile> read = store_->read(root);
        return read ? std::make_shared<const Tile>(std::move(*read)) : nullptr;
    } catch (const Error& error) {
        if (error.fault() != Fault::bad_data) throw;
        const std::lock_guard lock(mutex_);
        damage_.emplace_back(error.what());
    }
    return stand_in(root);
}

std::shared_ptr<const Tile> TileCache::stand_in(LocationCode root) const {
    Tile t;
    t.root = root;
    t.depth = 1;
    t.damaged = true;
    t.resampling = std::numeric_limits<float>::infinity();
    t.height.assign(4, 0.0f);
    t.deviation.assign(2, 0.0f);
    t.radius.assign(2, 0.0f);
    if (root.bisection_level() > 0) {
        if (const auto parent = tile(root.ancestor(root.bisection_level() - tile_levels)); parent && !parent->damaged) {
            const auto& corner = tile_layout().corners[tile_cells | (root.bits() & (tile_cells - 1))];
            if (!parent->undulation.empty()) t.undulation.resize(4);
            for (std::size_t v = 0; v < 3; ++v) {
                t.height[v] = parent->height[corner[v]];
                if (!t.undulation.empty()) t.undulation[v] = parent->undulation[corner[v]];
            }
            t.height[3] = 0.5f * (t.height[0] + t.height[1]);
            if (!t.undulation.empty()) t.undulation[3].m = 0.5 * (t.undulation[0].m + t.undulation[1].m);
        }
    }
    t.min_height = *std::min_element(t.height.begin(), t.height.end());
    t.max_height = *std::max_element(t.height.begin(), t.height.end());
    return std::make_shared<const Tile>(std::move(t));
}

std::size_t TileCache::memory_bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

std::vector<std::string> TileCache::damage() const {
    const std::lock_guard lock(mutex_);
    return damage_;
}

}  // namespace planet
