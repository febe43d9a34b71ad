#pragma once
// A store's tiles, placed on the planet for the walk, loaded when it first comes to them.

#include <array>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "planet/mesh/placed_tile.h"
#include "planet/store/tile_cache.h"

namespace planet {

/// Keeps every tile it has placed as long as it lives, whatever the cache's limit, but counts against it. What stands in
/// for a damaged tile may leave cracks about it: for pictures see resident_tiles.h. Safe to use from several threads.
class StoreTiles final : public TileSource {
  public:
    /// @param tiles must outlive this
    StoreTiles(const TileCache& tiles, const Placement& placement) : tiles_(&tiles), placement_(placement) {}

    ~StoreTiles() override;

    TileLayers layers() const override { return tiles_->store().metadata().layers; }
    const PlacedTile* tile(LocationCode root) const override;

    std::size_t count() const;
    std::size_t bytes() const;

  private:
    struct Shard {
        mutable std::mutex mutex;
        std::unordered_map<std::uint64_t, std::unique_ptr<const PlacedTile>> placed;
    };
    const TileCache* tiles_;
    Placement placement_;
    mutable std::array<Shard, 16> shards_;
};

}  // namespace planet
