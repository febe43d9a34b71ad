#pragma once
// The samples of a raster in tiles, each counted once, and their deviations as a picture. Tiles share their borders.

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "planet/elevation/raster_writer.h"
#include "planet/tin/tiled_tin.h"
#include "render/app/tin/tin_tile.h"

namespace render {

struct SampleCount {
    std::size_t covered = 0;    ///< valid ones in a triangle
    std::size_t uncovered = 0;  ///< valid ones in none
    std::size_t voids = 0;
    double squares = 0;  ///< sum of squared deviations, m²

    SampleCount& operator+=(const SampleCount& other) {
        covered += other.covered;
        uncovered += other.uncovered;
        voids += other.voids;
        squares += other.squares;
        return *this;
    }
};

/// A sample on a border counts in the last tile that covers it; one that none does, in the last that has it.
class TileSamples {
  public:
    /// @param error_grid where deviations go; may be null. finish() is the caller's
    TileSamples(const planet::TinTiling& tiling, planet::RasterWriter* error_grid)
        : tiling_(tiling), error_grid_(error_grid) {}

    /// Once for each tile. Safe from several threads. @param deviation of each sample of the tile, in rows, metres; NaN
    /// where there is no triangle; empty if there is none at all
    SampleCount count(std::size_t tile, const TileWindow& w, const std::vector<float>& deviation);
    /// After all tiles: what those that had to write a sample did not know.
    void write_the_rest();

  private:
    bool covers(std::size_t tile, glm::ivec2 p, const TileWindow& w) const;
    bool counts_here(std::size_t tile, glm::ivec2 p, bool covered, const TileWindow& w) const;
    void write(const TileWindow& w, const std::vector<float>& deviation);

    const planet::TinTiling& tiling_;
    planet::RasterWriter* error_grid_;
    std::mutex mutex_;
    std::map<std::pair<int, int>, float> kept_;  ///< by row and column: of samples that the next tile writes
};

}  // namespace render
