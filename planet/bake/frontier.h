#pragma once
// The tiles of a bake that are measured but whose records may still rise.
//
// Depth first, tiles are measured in the Sierpinski order. What a tile arrives at on its sides is told to the tiles
// beside it, which settle again if it is more than they knew. The records of a tile depend on finer diamonds only, and
// these lie in the tiles around it (tiles_around): once those are measured and none has anything left to do, the tile is
// final and leaves. So the frontier holds the tiles along the front of a space-filling curve, not those behind it.
//
//     . . . . . . .        f f f f f n .        f  final: in the store, not in memory
//     f f f f . . .        f f f n n n .        n  frontier
//     f f f n n . .        n n n n . . .        .  not measured yet
//
// Positions and records of a tile in the frontier (43 KiB) are kept while there is memory, and measured again from its
// heights when they are needed after all.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

#include "planet/bake/coverage.h"
#include "planet/bake/packed_heights.h"
#include "planet/bake/settling.h"

namespace planet {

/// A tile with tiles below it, from when its heights are known. What follows `waiting` changes as the tiles below do.
struct InnerTile {
    Tile tile;                         ///< its deviation: 1 where a diamond exists
    std::vector<std::uint8_t> exists;  ///< by local index
    InnerTile* above = nullptr;
    std::size_t waiting = 0;  ///< tiles below that are not final
    /// Each diamond's own deviation over all vertices below that have been measured; raised by several threads at once
    /// (raise_to). Radii: over the roots of the tiles below that are final.
    std::unique_ptr<TileRecords> records;
    std::atomic<bool> changed = false;  ///< since it was last saved

    /// What one takes, nearly.
    static constexpr std::size_t bytes = sizeof(TileRecords) + tile_cells * (1 + 4 * sizeof(float)) +
                                         tile_vertices * (sizeof(float) + sizeof(GeoidUndulation) + 2) + 1024;
};

/// A tile of the frontier. What is not marked otherwise belongs to the Frontier; a tile that is `busy` has been handed
/// out, and the rest of it belongs to who got it.
struct FrontierTile {
    LocationCode root;
    int depth = 0;
    InnerTile* above = nullptr;
    std::unique_ptr<InnerTile> inner;      ///< if it has tiles below
    PackedHeights height;                  ///< by vertex index; empty for inner tiles, which have their own
    std::vector<float> undulation;         ///< by vertex index, those that are not interpolated; at least the corners'
    OriginPlane origins;                   ///< by vertex index; as the heights
    float resampling = 0;                  ///< Tile::resampling
    glm::vec3 split_position{0};           ///< of the root's split vertex, rounded
    std::unique_ptr<TileRecords> records;  ///< nothing: to be measured again
    std::vector<SideSteps> mine;           ///< by side cell: what the tile arrives at
    std::vector<SideSteps> theirs;         ///< by side cell: what it was told (of the Frontier, busy or not)

    bool busy = false, settled = false;
    bool told = false;          ///< more than it knew
    int unmeasured_beside = 0;  ///< it pays to wait for them
    int unsettled_around = 0;   ///< itself included
    std::array<FrontierTile*, 3> beside{};
    std::array<FrontierTile*, 16> around{};
    std::size_t around_count = 0;
    std::list<FrontierTile*>::iterator kept;  ///< in Frontier's order of use, if its records can be dropped
    bool is_kept = false;

    /// Settled steps of side cell k.
    SideSteps steps(std::size_t k) const {
        return {std::max(mine[k].deviation, theirs[k].deviation), std::max(mine[k].radius, theirs[k].radius)};
    }
};

/// The other tiles that may hold a diamond on which one of this tile's depends, or one which depends on one of this
/// tile's: those that share a corner with it and two more. Fewer around the E_i and at level 0.
std::vector<LocationCode> tiles_around(LocationCode root);

/// Not safe to use from several threads: callers lock.
class Frontier {
  public:
    /// @param plan says what is planned and, by its marks, final
    explicit Frontier(TilePlan& plan) : plan_(plan) {}

    /// Takes in a tile that has been measured and settled by itself.
    void add(std::unique_ptr<FrontierTile> tile);

    /// A tile that was told more than it knew, busy; nullptr: none.
    FrontierTile* next_to_settle();
    /// Takes it back: `mine` and `records` are up to date with `theirs` as they were when it was handed out.
    void settled(FrontierTile& tile);

    /// A tile whose records are final; nullptr: none.
    std::unique_ptr<FrontierTile> next_final();

    std::size_t size() const { return tiles_.size(); }
    /// Of the heights of its tiles and their origins.
    std::size_t height_bytes() const { return height_bytes_; }
    /// How many tiles have records that could be dropped.
    std::size_t kept() const { return kept_.size(); }
    /// Drops the records of the tiles that have not been used for longest until `most` are kept.
    void keep_at_most(std::size_t most);

    /// Records to be written over: those of a tile that dropped them, or new ones.
    std::unique_ptr<TileRecords> spare_records();
    void give_back(std::unique_ptr<TileRecords> records);

  private:
    void meet_around(FrontierTile& tile);
    void meet_beside(FrontierTile& tile);
    void tell(const FrontierTile& from, Side side, FrontierTile& to);
    void advance(FrontierTile& tile);
    void set_settled(FrontierTile& tile, bool settled);
    void finish(FrontierTile& tile);
    void keep(FrontierTile& tile);
    void forget(FrontierTile& tile);

    TilePlan& plan_;
    std::unordered_map<std::uint64_t, std::unique_ptr<FrontierTile>> tiles_;
    std::deque<FrontierTile*> to_settle_;
    std::deque<std::unique_ptr<FrontierTile>> final_;
    std::size_t height_bytes_ = 0;
    std::list<FrontierTile*> kept_;  // the last used first
    std::vector<std::unique_ptr<TileRecords>> spare_;
};

}  // namespace planet
