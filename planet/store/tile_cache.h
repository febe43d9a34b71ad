#pragma once
// Decoded tiles of a store, kept in memory up to a limit.

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "planet/mesh/tile.h"
#include "planet/store/elevation_store.h"

namespace planet {

/// The memory of a tile.
std::size_t bytes_of(const Tile& tile);

/// Safe to use from several threads. Tiles in use live on when the cache drops them.
class TileCache {
  public:
    /// @param store must outlive the cache @param memory_bytes limit of the tiles kept; the tile last asked for is kept
    /// whatever its size
    explicit TileCache(const ElevationStore& store, std::size_t memory_bytes = std::size_t{256} << 20);

    /// The tile below a cell, nullptr if the store has none. A tile that cannot be read is replaced by one that holds
    /// its corners' heights, cannot be split and says `damaged`: the cells of the tile above stand in for it.
    std::shared_ptr<const Tile> tile(LocationCode root) const;

    const ElevationStore& store() const { return *store_; }
    std::size_t memory_bytes() const;
    /// One line for each damaged tile met so far.
    std::vector<std::string> damage() const;

  private:
    struct Entry {
        std::uint64_t code;
        std::shared_ptr<const Tile> tile;
    };
    std::shared_ptr<const Tile> load(LocationCode root) const;
    std::shared_ptr<const Tile> stand_in(LocationCode root) const;

    const ElevationStore* store_;
    std::size_t limit_;
    mutable std::mutex mutex_;
    mutable std::list<Entry> recent_;  // the last used first
    mutable std::unordered_map<std::uint64_t, std::list<Entry>::iterator> index_;
    mutable std::size_t bytes_ = 0;
    mutable std::vector<std::string> damage_;
};

}  // namespace planet
