#pragma once
// A store's tiles for a moving eye: loaded by other threads, ahead of it, within the memory limit, and free of cracks
// whichever of them are there.
//
// From one update() to the next the tiles and the diamonds that exist stay as they are: what segments were built from
// holds. A still picture is settled instead: settle() waits until nothing is missing, and the mesh then is that of the
// whole store, whatever came in which order, and whatever was there before.
//
// A tile that cannot be read never comes: the cells of the tile above stand in for it, as they do for one that has not
// come yet.

#include <future>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "planet/mesh/segments.h"
#include "planet/store/tile_cache.h"
#include "planet/streaming/resident_set.h"
#include "planet/streaming/tile_loader.h"

namespace planet {

/// How complete the tiles are for the view of the last update.
struct Residency {
    std::size_t pending = 0;  ///< tiles that the view is known to need and that have not come yet
    std::size_t damaged = 0;  ///< and that never will: they cannot be read
    /// What pending and damaged tiles hide. Bounds by the tiles above them, known before they come: the picture is off by
    /// at most the larger of Segments::deviation_max_m() and this, and of Segments::ratio_max() and this.
    double hidden_deviation_m = 0;
    double hidden_ratio = 0;  ///< infinite where the eye may be beside what is hidden
};

/// For reports.
struct ResidentCounts {
    std::size_t tiles = 0;         ///< there now
    std::size_t tile_bytes = 0;    ///< their memory
    std::size_t tiles_loaded = 0;  ///< since the beginning, those that were loaded again counted again
    std::size_t memory_limit_bytes = 0;
    std::size_t memory_peak_bytes = 0;  ///< of these tiles and of decoded ones; above the limit if a view needed that
};

/// Where an eye that moves on will be. @param velocity_m_s ecef
SegmentView view_ahead(const SegmentView& view, const glm::dvec3& velocity_m_s, double seconds);

/// The view after two of a motion that goes on as it is: the eye takes the same step, and the planes turn by as much.
SegmentView view_after(const SegmentView& before, const SegmentView& now);

/// The functions are for one thread; between them, walks may run on any.
class ResidentTiles final : public TileSource {
  public:
    static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

    /// Waits for the faces. @param cache must outlive this; its limit counts @param threads that load, 0: one for each
    /// processor @param reader where tiles come from, nullptr: the cache
    ResidentTiles(const TileCache& cache, const Placement& placement, unsigned threads = 0,
                  const TileReader* reader = nullptr);
    ~ResidentTiles() override;

    TileLayers layers() const override { return set_.layers(); }
    /// Of those that are there.
    const PlacedTile* tile(LocationCode root) const override { return set_.tile(root); }

    /// Takes in what has come, drops what was not needed for longest if memory is short, and asks for what the view
    /// needs. Does not wait. @param ahead a view that may come next: its tiles are asked for after those of `view`, as
    /// far as memory allows @param most takes in so many tiles, which bounds the time it takes; the rest is for the next
    /// @return cells in which the mesh may differ now (for Segments::invalidate), until the next call
    std::span<const LocationCode> update(const SegmentView& view, const SegmentView* ahead = nullptr,
                                         std::size_t most = unlimited);

    /// The same, until nothing is pending. What the view needs stays even if it is more than the limit.
    std::span<const LocationCode> settle(const SegmentView& view);

    /// Returns once another tile has come for update() to take in, or none is on its way.
    void wait();
    std::size_t on_their_way();

    /// Places what is there anew: nothing is loaded again. Waits for what is being loaded.
    /// @return cells in which the mesh may differ now: all
    std::span<const LocationCode> place(const Placement& placement);

    const Residency& residency() const { return residency_; }
    ResidentCounts counts() const;

  private:
    /// A tile that neither view needed when it was listed.
    struct IdleTile {
        std::uint64_t last;  ///< needed or wanted
        LocationCode root;
        ResidentTile* tile;
    };

    LoadedTile load(LocationCode root) const;
    void take_in(std::size_t most = unlimited);
    void take_in(LoadedTile loaded);
    bool up_to_date(const SegmentView& view, const SegmentView* ahead) const;
    std::vector<TileRequest> find_needs(std::size_t& bytes);
    void ask(std::vector<TileRequest> requests, std::size_t bytes);
    void find_needs_ahead(std::size_t bytes, std::vector<TileRequest>& requests);
    void finish_asking();
    bool is_held(const ResidentTile& tile) const;
    void keep_within_limit();
    void list_idle();
    void count_memory();

    const TileCache& cache_;
    const TileReader& reader_;
    Placement placement_;
    ResidentSet set_;
    std::unordered_set<std::uint64_t> damaged_, absent_;
    std::vector<IdleTile> idle_;  // the first to be dropped last
    std::uint64_t mark_ = 0;
    std::uint64_t needed_mark_ = 0, wanted_mark_ = 0;
    std::size_t loaded_ = 0, counted_bytes_ = 0;
    bool asked_ = false;  // for view_ and ahead_, with the tiles that are there
    SegmentView view_;
    std::optional<SegmentView> ahead_;
    Residency residency_;
    std::vector<LocationCode> changes_;
    TileLoader loader_;         // its threads end before what they use
    std::future<void> asking_;  // for what lies ahead, while the mesh is made; last, as it uses the loader
};

}  // namespace planet
