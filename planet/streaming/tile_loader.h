#pragma once
// Tiles loaded by other threads, the most wanted first.

#include <condition_variable>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <unordered_set>
#include <vector>

#include "planet/mesh/placed_tile.h"

namespace planet {

struct TileRequest {
    LocationCode root;
    double priority = 0;  ///< the higher, the sooner
};

/// What came of a request.
struct LoadedTile {
    LocationCode root;
    std::unique_ptr<PlacedTile> tile;  ///< nullptr: there is none, or it is damaged
    bool damaged = false;
    std::vector<LocationCode> support;  ///< tile_support() of the tile
};

/// The functions are for one thread.
class TileLoader {
  public:
    /// Called on several threads at once. What it throws is thrown on by take().
    using Load = std::function<LoadedTile(LocationCode)>;

    /// @param threads 0: one for each processor
    explicit TileLoader(Load load, unsigned threads = 0);
    /// Waits for tiles that are being loaded.
    ~TileLoader();
    TileLoader(const TileLoader&) = delete;

    /// What is wanted from now on, in place of what was: requests that are not repeated and not begun are withdrawn.
    /// What is being loaded or waits to be taken is not loaded again.
    void request(std::vector<TileRequest> wanted);
    /// What has been loaded and not taken yet, the first loaded first. @param most so many tiles
    std::vector<LoadedTile> take(std::size_t most = std::numeric_limits<std::size_t>::max());
    /// Returns once take() has this many to give or throws, or nothing more is on its way.
    void wait(std::size_t tiles = 1);
    /// How many tiles are requested, being loaded, or loaded and not taken.
    std::size_t on_their_way() const;

  private:
    void work(const std::stop_token& stop);

    Load load_;
    mutable std::mutex mutex_;
    std::condition_variable_any work_to_do_;
    std::condition_variable loaded_or_idle_;
    std::vector<TileRequest> waiting_;         // a heap, the most wanted on top
    std::unordered_set<std::uint64_t> begun_;  // being loaded, or loaded and not taken
    std::vector<LoadedTile> loaded_;
    std::exception_ptr failure_;
    std::size_t loading_ = 0;
    std::vector<std::jthread> threads_;  // last: they end before what they use
};

}  // namespace planet
