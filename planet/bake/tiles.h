#pragma once
// What a bake computes of a tile by itself: heights, deviations of its cells and of those above over its vertices, where
// radii start, what resampling lost, bytes.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "planet/bake/bake.h"
#include "planet/bake/existence.h"
#include "planet/bake/frontier.h"
#include "planet/bake/resampling.h"
#include "planet/store/tile_codec.h"

namespace planet {

/// What a bake's tiles are made from. Read by all threads.
struct BakeScene {
    const ElevationField& field;
    const BakeOptions& options;
    const TilePlan& plan;
    TileScale scale;
};

/// Sets `value` to at least `least`; safe from several threads.
void raise_to(float& value, float least);

/// What a tile that has become final says to the one above it: the record of its root and its height range. Not safe
/// from several threads.
void report_above(const FrontierTile& tile, float min_height, float max_height);

/// Time by step, seconds.
enum class BakeStep { resampling, deviation, settling, certifying, compression };
inline constexpr std::size_t bake_steps = 5;
using BakeSeconds = std::array<double, bake_steps>;

/// One thread's.
class TileMaker {
  public:
    explicit TileMaker(const BakeScene& scene) : scene_(scene), existence_(scene.plan) {}

    /// A tile with tiles below it. @param above the tile above, nullptr for a face
    std::unique_ptr<InnerTile> open(LocationCode root, InnerTile* above);
    /// A tile without: settled, its vertices tested against all cells above.
    /// @param theirs by side cell, what is known of final tiles beside it; empty: nothing
    std::unique_ptr<FrontierTile> measure(LocationCode root, InnerTile* above, std::vector<SideSteps> theirs,
                                          std::unique_ptr<TileRecords> records);
    /// A tile all of whose tiles below are final, settled.
    std::unique_ptr<FrontierTile> enter_frontier(std::unique_ptr<InnerTile> inner, std::vector<SideSteps> theirs);
    /// Settles a tile of the frontier with what it was told, measuring it again if it has dropped its records.
    /// @param records to be used if it has
    void settle(FrontierTile& tile, std::span<const SideSteps> theirs, std::unique_ptr<TileRecords> records);
    /// The bytes of a final tile.
    std::vector<std::uint8_t> encode(FrontierTile& tile);
    /// Least and largest height, as of the tile last encoded.
    const Tile& encoded() const { return baked_.tile; }

    const BakeSeconds& seconds() const { return seconds_; }

  private:
    template <class Work>
    void timed(BakeStep step, Work work);

    Corners root_corners(LocationCode root) const;
    void sample(Tile& tile, InnerTile* above);
    void quantize(std::span<float> heights);
    [[noreturn]] void refuse_heights(std::span<const float> heights) const;
    void sample_undulations(Tile& tile, const InnerTile* above);
    void find_lacks_below(LocationCode root, int depth);
    void set_own(TileRecords& records, bool inner);
    void measure_above();
    void find_cells_above(LocationCode root, InnerTile* above);
    void restore(const FrontierTile& tile);
    std::unique_ptr<FrontierTile> frontier_tile(LocationCode root, int depth, InnerTile* above,
                                                std::vector<SideSteps> theirs);

    struct CellAbove {
        LocationCode cell;
        Corners corners;
        CellPlane plane;
        InnerTile* holder;
        std::uint16_t vertex;  ///< its split vertex in the holder
        bool exists;
    };

    const BakeScene& scene_;
    Existence existence_;
    BakeSeconds seconds_{};
    TileLattice lattice_;
    Tile tile_;  // of the tile being measured
    std::vector<std::uint8_t> exists_;
    std::vector<std::uint8_t> lacks_below_;
    std::vector<float> deviation_, radius_;
    std::vector<glm::dvec3> normals_;
    std::vector<WeighedOrigin> origins_;
    std::vector<GeoidUndulation> undulations_;
    std::vector<CellAbove> above_;  // by bisection level
    TileResampling resampling_;
    BakedTile baked_;
};

}  // namespace planet
