#pragma once
// A TIN of a raster in tiles: borders first, then each tile by itself, on as many threads as there are. What is on a
// border follows from the samples on it and beside it alone, so neighbours have the same vertices there, bit for bit,
// without knowing of each other, and the raster need not fit into memory.

#include <array>
#include <functional>

#include "planet/tin/height_grid.h"
#include "planet/tin/measure.h"
#include "planet/tin/tin_features.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Tiles of `step` x `step` samples and one more, which they share with the next; those at the end are smaller.
class TinTiling {
  public:
    /// @param width, height of the raster, at least 2 samples @param step at least 1, at most max_step
    TinTiling(int width, int height, int step);
    static constexpr int max_step = 1 << 14;

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    std::size_t count() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }
    /// First and last sample of a tile. @param tile row * columns() + column
    glm::ivec2 low(std::size_t tile) const;
    glm::ivec2 high(std::size_t tile) const;
    /// Those that have a sample: up to four, ascending.
    std::vector<std::size_t> tiles_at(glm::ivec2 sample) const;
    int step() const { return step_; }
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    int width_, height_, step_, columns_, rows_;
};

enum class TinQuality {
    fast,      ///< greedy insertion
    standard,  ///< and one pass of pruning
    best,      ///< pruning until nothing more can go
};

/// Up to where a TIN is refined: while a sample deviates by more than the tolerance, and, by a metric that adds up, while
/// its triangle has more than the least priority. One such bound for all tiles makes of them what one greedy insertion that
/// has come to it makes of the whole, but for borders. Without a least priority no sample deviates by more than the
/// tolerance, by any metric.
struct TinBound {
    double tolerance = 0;  ///< metres, >= 0
    TinMetric metric = TinMetric::local;
    double least_priority = 0;  ///< m for regional, m^2 for rms; local has none
};

struct TiledTinOptions {
    double tolerance = 0;  ///< metres, >= 0
    TinQuality quality = TinQuality::standard;
    unsigned threads = 0;  ///< 0: one a processor. The same bits whatever the number.
    TinMetric metric = TinMetric::local;
    double least_priority = 0;  ///< see TinBound; above 0 nothing is pruned

    TinBound bound() const { return {tolerance, metric, least_priority}; }
};

/// What a tile has to have besides what its heights call for.
struct TinTileNeeds {
    std::vector<glm::ivec2> border;  ///< samples on its border: a neighbour has them, too. May be void
    TinFeatures features = {};       ///< within it (cut_into_tiles())
};

/// A tile's part of the whole.
struct TinTile {
    std::size_t tile = 0;
    /// Vertices are (column, row) of the raster. May be empty: all void.
    TinMesh mesh;
    /// Vertices on the low and high row, and on the low and high column, ascending: those of the mesh, by index. Of two
    /// neighbours one may have fewer, where all that the other has there is beside a void.
    std::array<std::vector<std::uint32_t>, 4> border;
    FeatureReport features = {};
};

/// The window of a raster from `low` to `high`, both included. Called from several threads.
using WindowReader = std::function<HeightGrid(glm::ivec2 low, glm::ivec2 high)>;

/// Calls sink for every tile, one at a time, in any order. What either function throws ends the work and is thrown on.
/// @param read asked for windows one sample larger than a tile on each side, as far as there is a raster
void tin_tiles(const TinTiling& tiling, const WindowReader& read, const TiledTinOptions& options,
               const std::function<void(TinTile&&)>& sink);

/// The tile of a grid that holds at least it and the samples around it. Features may add vertices to its border that
/// tile_border() does not tell: where two cross there, or lead around a void. Its neighbours must be told.
/// @param low, high of the tile in the grid @param offset of the grid in the raster @param needs in samples of the grid
TinTile tin_tile(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high, const TiledTinOptions& options,
                 glm::ivec2 offset = {0, 0}, const TinTileNeeds& needs = {});

/// The vertices on a tile's border, as its neighbours have them: side by side, corners in two of them.
/// @param grid, low, high as for tin_tile() @param needed samples on the border that have to be
/// among them
std::vector<glm::ivec2> tile_border(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high, const TinBound& bound,
                                    const std::vector<glm::ivec2>& needed = {});

/// Samples a tile that keep its work in the processor's cache.
inline constexpr int tiled_tin_step = 256;

/// All tiles of a raster in memory as one mesh: no vertex twice. @param step samples a tile
TinMesh tiled_tin(const HeightGrid& grid, const TiledTinOptions& options, int step = tiled_tin_step);

/// Joins tiles into one mesh: vertices at the same sample become one. @param tiles in any order
TinMesh joined(std::vector<TinTile> tiles);

}  // namespace planet
