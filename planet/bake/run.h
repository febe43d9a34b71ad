#pragma once
// The threads of a bake and what they do next.
//
// One lock guards everything but the work on single tiles. A thread looks for something to do in an order that lets
// tiles leave memory soon: write what is final, encode final tiles, settle tiles that were told something, let tiles
// whose tiles below are final enter the frontier, and only then measure the next tile. Tiles are measured depth first in
// ascending code; with tiles below, a tile is opened (sampled) before they are.

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "planet/bake/file.h"
#include "planet/bake/frontier.h"
#include "planet/bake/tiles.h"

namespace planet {

/// Whether the limit allows to begin.
bool has_memory_for(const BakeOptions& options, const TilePlan& plan);
/// Error(bad_usage): the limit is too low.
[[noreturn]] void refuse_memory(const BakeOptions& options);

class BakeRun {
  public:
    /// @param plan its marks are set: tiles that are in the file already
    BakeRun(const BakeScene& scene, TilePlan& plan, BakeFile& file);

    /// Bakes all that is not in the file.
    void run();

    double resampling_max_m() const { return resampling_max_m_; }  ///< of all tiles
    std::uint64_t vertices_resumed() const { return vertices_resumed_; }
    std::size_t most_memory_bytes() const { return most_bytes_; }
    const BakeSeconds& seconds() const { return seconds_; }  ///< of all threads
    double writing_seconds() const { return writing_seconds_; }

  private:
    using Lock = std::unique_lock<std::mutex>;
    struct OpenLevel {
        InnerTile* above;
        std::vector<LocationCode> below;
        std::size_t next = 0;
    };
    struct Next {
        LocationCode root;
        InnerTile* above;
        bool has_tiles_below;
    };

    void mark_written();
    void work(bool tells);
    void tell_progress(Lock& lock);
    bool work_once(TileMaker& maker, Lock& lock);
    std::optional<Next> next_to_measure();
    void open(TileMaker& maker, Lock& lock, const Next& next);
    void measure(TileMaker& maker, Lock& lock, const Next& next);
    void enter_frontier(TileMaker& maker, Lock& lock);
    void settle(TileMaker& maker, Lock& lock, FrontierTile& tile);
    void complete_below(InnerTile& inner);
    void finish(TileMaker& maker, Lock& lock, std::unique_ptr<FrontierTile> tile);
    void write(Lock& lock);
    std::vector<SideSteps> told_by_file(Lock& lock, LocationCode root);
    bool restore(InnerTile& inner);
    void keep_within_memory();

    const BakeScene& scene_;
    TilePlan& plan_;
    BakeFile& file_;
    std::size_t threads_, least_bytes_;  // least_bytes_: asking for the number of processors reads a file

    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t working_ = 0;
    bool stopped_ = false;

    std::vector<OpenLevel> open_;  // the path down to what is measured next
    bool opening_ = false;
    std::unordered_map<std::uint64_t, std::unique_ptr<InnerTile>> inner_;
    std::deque<std::unique_ptr<InnerTile>> complete_below_;
    Frontier frontier_;
    std::vector<TileRow> to_write_;
    std::vector<TileRow> to_save_;  // what complete tiles above know, before they settle
    std::size_t to_write_bytes_ = 0;
    bool writing_ = false;

    std::size_t inner_bytes_ = 0, most_bytes_ = 0;
    std::uint64_t vertices_ = 0, vertices_told_ = 0, vertices_resumed_ = 0;
    double resampling_max_m_ = 0, writing_seconds_ = 0;
    BakeSeconds seconds_{};
};

}  // namespace planet
