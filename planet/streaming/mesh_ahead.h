#pragma once
// While one view is drawn, the mesh of the next is made by another thread: what a frame waits for is then what the eye did
// otherwise than expected.

#include <future>
#include <optional>

#include "planet/mesh/segments.h"
#include "planet/streaming/resident_tiles.h"

namespace planet {

/// Between begin() and finish() the tiles are the thread's; segments may be read.
class MeshAhead {
  public:
    /// Both must outlive this.
    MeshAhead(ResidentTiles& tiles, Segments& segments) : tiles_(tiles), segments_(segments) {}

    /// Takes in tiles and prepares segments for a view that is expected next.
    /// @param ahead, most as of ResidentTiles::update @param threads that make segments
    void begin(const SegmentView& next, const std::optional<SegmentView>& ahead, std::size_t most, int threads);

    /// Waits for what was begun. @return whether something was
    bool finish();

    /// What the last begin() took, by the clock of its thread.
    double seconds() const { return seconds_; }

  private:
    ResidentTiles& tiles_;
    Segments& segments_;
    double seconds_ = 0;
    std::future<void> making_;  // last: uses the rest
};

}  // namespace planet
