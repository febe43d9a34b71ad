#pragma once
// Which tiles a view needs, so that the mesh of what is in memory is that of the whole store.

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "planet/mesh/segments.h"
#include "planet/streaming/resident_set.h"

namespace planet {

/// A tile that a view needs and that is not there.
struct MissingTile {
    LocationCode root;
    float deviation;  ///< m, exaggerated: nothing that depends on it deviates more
    /// What depends on it is off by at most this many times max_pixel_deviation; infinite where the eye may be beside it.
    double ratio;
};

/// Follows the walk of Segments from tile to tile, without looking into tiles that have none below. Needed are the tiles
/// that the segments in view are made of, and those that their diamonds depend on, which can lie out of view. Where all
/// are there, every diamond that the test splits in these segments exists.
class ViewNeeds {
  public:
    /// @param stamp ResidentTile::needed or wanted: becomes `mark` in tiles that are needed
    /// @param mark a number of its own
    ViewNeeds(ResidentSet& resident, std::uint64_t ResidentTile::*stamp, std::uint64_t mark)
        : resident_(resident), stamp_(stamp), mark_(mark) {}

    void add(const SegmentView& view);

    /// Each once, in no particular order. Below these, more may be.
    const std::vector<MissingTile>& missing() const { return missing_; }
    /// Those that are there, each once, in no particular order.
    const std::vector<ResidentTile*>& there() const { return there_; }

  private:
    void visit(ResidentTile& tile, unsigned i, bool in_segment);
    void visit_below(ResidentTile& tile, unsigned position, bool in_segment);
    void follow(ResidentTile& tile);
    void hold(ResidentTile& tile);
    void hold(LocationCode root);
    void stamp(ResidentTile& tile);
    void miss(LocationCode root, const SplitRecord& bound);
    bool hidden(const SplitRecord& record) const;
    bool ends_patch(const SplitRecord& record, int bisection_level) const;

    ResidentSet& resident_;
    std::uint64_t ResidentTile::*stamp_;
    std::uint64_t mark_;
    const SegmentView* view_ = nullptr;
    std::vector<MissingTile> missing_;
    std::vector<ResidentTile*> there_;
    std::unordered_set<std::uint64_t> known_missing_;
};

}  // namespace planet
