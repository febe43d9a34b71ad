#pragma once
// Decoded tiles of a store, kept in memory up to a limit that they share with the tiles kept for drawing.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "planet/mesh/tile.h"
#include "planet/store/elevation_store.h"
#include "planet/store/tile_reader.h"

namespace planet {

inline constexpr std::size_t default_tile_memory_bytes = std::size_t{256} << 20;

/// The memory of a tile.
std::size_t bytes_of(const Tile& tile);

/// Safe to use from several threads. Tiles in use live on when the cache drops them. Two threads never load the same
/// tile at once: the second waits for the first.
class TileCache final : public TileReader {
  public:
    /// @param store must outlive the cache @param memory_bytes limit of the tiles kept, those drawn from among them; the
    /// tile last asked for is kept whatever its size
    explicit TileCache(const ElevationStore& store, std::size_t memory_bytes = default_tile_memory_bytes);

    /// The tile below a cell, nullptr if the store has none. A tile that cannot be read is replaced by one that holds
    /// its corners' heights, cannot be split and says `damaged`: the cells of the tile above stand in for it.
    std::shared_ptr<const Tile> tile(LocationCode root) const override;

    /// Counts tiles placed for drawing against the limit: decoded ones make room for them. They are not dropped here:
    /// where they alone are beyond the limit, so is the total.
    /// @param change bytes that came, or went if below 0
    void count_drawn_bytes(std::ptrdiff_t change) const;

    const ElevationStore& store() const { return *store_; }
    std::size_t memory_limit_bytes() const { return limit_; }
    /// Of all that is counted: now, and the most there ever was.
    std::size_t memory_bytes() const;
    std::size_t memory_peak_bytes() const;
    /// One line for each damaged tile met so far.
    std::vector<std::string> damage() const;

  private:
    struct Entry {
        std::uint64_t code;
        std::shared_ptr<const Tile> tile;
    };
    std::shared_ptr<const Tile> load(LocationCode root) const;
    std::shared_ptr<const Tile> stand_in(LocationCode root) const;
    void take_corners_of_other_faces(Tile& tile) const;
    void keep(std::uint64_t code, const std::shared_ptr<const Tile>& tile) const;
    void drop_beyond_limit() const;

    const ElevationStore* store_;
    std::size_t limit_;
    mutable std::mutex mutex_;
    mutable std::condition_variable loaded_;
    mutable std::unordered_set<std::uint64_t> loading_;
    mutable std::list<Entry> recent_;  // the last used first
    mutable std::unordered_map<std::uint64_t, std::list<Entry>::iterator> index_;
    mutable std::size_t decoded_bytes_ = 0, drawn_bytes_ = 0, peak_bytes_ = 0;
    mutable std::unordered_set<std::uint64_t> damaged_;
    mutable std::vector<std::string> damage_;
};

}  // namespace planet
