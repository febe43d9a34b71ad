#pragma once
// One tile of `octaglobe tin --tile`: read, triangulated and certified; and what all tiles have in common.

#include <memory>
#include <optional>

#include "planet/tin/tiled_tin.h"
#include "render/app/drape.h"
#include "render/app/normals.h"
#include "render/app/progress.h"
#include "render/app/tin/tin_source.h"
#include "render/app/tin/tin_written.h"

namespace render {

/// A tile's samples and those beside them.
struct TileWindow {
    glm::ivec2 low, high;  ///< first and last sample of the tile, in the raster
    glm::ivec2 first;      ///< of the window
    planet::HeightGrid window, tile;

    /// Of a sample of the raster in the window.
    bool valid(glm::ivec2 p) const { return window.valid(p - first); }
};

struct MadeTile {
    WrittenTin tin;                  ///< in samples of the tile
    planet::FeatureReport features;  ///< of the tile's own
    /// Samples of the raster on the tile's border that have to be vertices, too, of it and of its neighbours. If there are
    /// any, the tile is not to be written.
    std::vector<glm::ivec2> needed;
};

/// Up to where all tiles are refined.
struct TileAim {
    double tolerance = 0;  ///< m
    /// See planet::TinBound. Above 0 there are no more triangles than a budget has, and samples may be farther than the
    /// tolerance.
    double least_priority = 0;
};

class TileMaker {
  public:
    /// Throws as TinSource and its frame() do, and planet::Error(bad_usage) for too many tiles.
    TileMaker(const TinCommand& command, const TinSource& source);

    const planet::TinTiling& tiling() const { return tiling_; }
    const planet::RasterFrame& frame() const { return frame_; }
    double grid_step() const { return grid_step_; }  ///< of a .glb, for all tiles; 0: none

    /// First of all, reads all heights where tiles must agree on what follows from them: a .glb's grid, the floor of
    /// solids. Throws planet::Error(bad_data) if there are none.
    void survey(Progress& progress);

    TileWindow read(std::size_t tile) const;
    /// Safe from several threads. @param needs in samples of the raster
    /// @return nothing where there is no triangle
    std::optional<MadeTile> make(const TileWindow& w, const planet::TinTileNeeds& needs, const TileAim& aim) const;

    /// Of a .glb; nothing for other formats and for solids.
    planet::MeshLooks looks(const WrittenTin& tin, const TileWindow& w) const;

    [[noreturn]] void refuse_void() const;

  private:
    planet::TinTiling make_tiling() const;

    const TinCommand& command_;
    const TinSource& source_;
    const planet::RasterFrame frame_;
    std::optional<planet::RasterFrame> tangent_;  ///< over whose plane tiles are made, of a frame that curves
    const planet::TinTiling tiling_;
    const DrapeMap map_;
    std::optional<Drape> drape_;

    double scale_ = 1;  ///< of the tolerance, in frames that are not affine
    double grid_step_ = 0;
    double rounding_ = 0;  ///< m: by how much the format moves the ground at most
    std::optional<TinFloor> floor_;
};

}  // namespace render
