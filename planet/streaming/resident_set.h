#pragma once
// The tiles that are in memory, and the diamonds that exist with them.
//
// The rule is the bake's: a diamond exists iff the tiles of both its cells are there, as deep as it lies, and both its
// parents exist. What exists is the greatest conforming set of the store's diamonds, so a walk over it is free of cracks
// whichever tiles are there. All others are closed (SplitRecord::deviation below 0): their cells stay whole.
//
// A tile counts as deep as it was opened. Views from afar split a few of its 12 levels: following thousands of diamonds
// that none of them asks for took most of the time in which tiles were taken in.
//
// Existence depends on coarser levels only: what came or went is followed from the coarsest level down, and only to
// the diamonds below one that changes. The fixpoint is unique: the order in which tiles came does not matter.

#include <array>
#include <bitset>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/view.h"

namespace planet {

/// A tile in memory, tied to those it depends on. Or one that is not there, but that others depend on.
struct ResidentTile {
    LocationCode root;
    std::unique_ptr<PlacedTile> tile;                              ///< nullptr: not there
    std::size_t bytes = 0;                                         ///< of the tile and what ties it; 0: not there
    std::vector<ResidentTile*> support;                            ///< see tile_support(), there or not
    ResidentTile* above = nullptr;                                 ///< the one that holds the cell of the root
    std::array<ResidentTile*, 3> beside{};                         ///< of the same level, by Side of the root
    std::vector<ResidentTile*> below;                              ///< by ChildBounds::index()
    std::size_t children = 0;                                      ///< how many of them are there
    std::size_t supported = 0;                                     ///< how many tiles have it in their support
    int open_depth = 0;                                            ///< diamonds of so many levels may exist
    SplitRecord unopened{};                                        ///< passes every test that splits deeper ones
    bool fresh = true;                                             ///< came since changes were last taken
    std::unique_ptr<std::bitset<1u << tile_levels>> changed;       ///< of its cells, since then; nullptr: none
    std::uint64_t needed = 0, wanted = 0, followed = 0, held = 0;  ///< stamps of ViewNeeds
};

/// One thread's. While walks run over its tiles it may not be changed.
class ResidentSet final : public TileSource {
  public:
    /// @param layers of all tiles to come
    explicit ResidentSet(TileLayers layers = {}) : layers_(layers) {}

    TileLayers layers() const override { return layers_; }
    /// nullptr: not there.
    const PlacedTile* tile(LocationCode root) const override;
    ResidentTile* find(LocationCode root);
    ResidentTile& face(int face) { return *find(LocationCode::face_root(face)); }

    /// Adds a tile, which counts as one of no depth. The tile above it must be there, itself not.
    /// @param tile with all its diamonds closed @param support tile_support() of it
    ResidentTile& insert(std::unique_ptr<PlacedTile> tile, std::span<const LocationCode> support);
    /// Lets it count as a tile of at least this depth, if it is as deep. To be followed by settle().
    void open(ResidentTile& tile, int depth);
    /// Opens it, if it is not yet as deep as the test may split it, to some levels more than that.
    void open_for(ResidentTile& tile, const SplitTest& test);
    /// Takes a tile out. None below it may be there. To be followed by settle().
    void erase(LocationCode root);
    /// Opens and closes diamonds until the rule holds. Before, a walk may meet cracks.
    void settle();
    /// Cells in which the mesh may differ from when this was last asked; none holds another. Along the curve.
    std::vector<LocationCode> take_changes();

    /// Places all tiles anew. @param threads 0: one for each processor
    void place(const Placement& placement, unsigned threads = 0);

    std::size_t size() const { return size_; }
    std::size_t bytes() const { return bytes_; }
    std::vector<ResidentTile*> all();

  private:
    /// A cell whose diamond may have to be opened or closed. By then its tile may have gone.
    struct Unsettled {
        ResidentTile* tile;
        unsigned local;
    };

    ResidentTile& slot(LocationCode root);
    void free_unused();
    void tie(ResidentTile& tile, std::span<const LocationCode> support);
    void untie(ResidentTile& tile);
    void unsettle(ResidentTile& tile, unsigned local);
    void unsettle_children(ResidentTile& tile, unsigned local);
    void settle(ResidentTile& tile, unsigned local);
    void settle_side(ResidentTile& tile, unsigned local, ResidentTile* beside);
    void set_open(ResidentTile& tile, unsigned local, bool open);
    void change(ResidentTile& tile, unsigned local);

    bool may_open(const ResidentTile& tile, unsigned local) const;

    TileLayers layers_;
    std::unordered_map<std::uint64_t, ResidentTile> tiles_;
    std::array<std::vector<Unsettled>, max_bisection_level> unsettled_;  // by bisection level
    std::vector<LocationCode> unused_;                                   // may be: to be freed
    std::vector<LocationCode> changes_;
    std::vector<LocationCode> marked_;  // fresh tiles, and those with cells that have changed
    std::size_t size_ = 0, bytes_ = 0;
};

/// The other tiles of a tile's own level that hold an ancestor of one of its diamonds. Where these, the tiles above
/// all of them and the support of those are there, every diamond of the tile exists.
std::vector<LocationCode> tile_support(LocationCode root, int depth);

}  // namespace planet
