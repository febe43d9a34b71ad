#pragma once
// A tile placed on its planet, ready for the walk: what the split test reads and the vertices it emits.

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/grid.h"
#include "planet/mesh/tile.h"

namespace planet {

/// What one cell's split test reads: its split vertex (ecef, metres, at exaggerated height), deviation and radius.
/// Both cells of a diamond hold the same bits. deviation 0: never split. Below 0: the diamond exists in the store, with
/// the deviation -deviation, but not with the tiles that are in memory (streaming/resident_set.h): not split.
struct SplitRecord {
    float x, y, z;
    float deviation;
    float radius;
};

/// As if the diamond existed.
inline SplitRecord opened(SplitRecord record) {
    record.deviation = std::abs(record.deviation);
    return record;
}

/// Puts heights on the planet.
struct Placement {
    Ellipsoid ellipsoid = wgs84;
    double exaggeration = 1;  ///< >= 0, of the height above the datum; the geoid is not exaggerated

    /// @param n unit geodetic normal; @param H height above the datum, metres; @param N datum above the ellipsoid
    glm::dvec3 ecef(const glm::dvec3& n, double H, GeoidUndulation N) const {
        return ecef_from_normal(ellipsoid, n, {H * exaggeration + N.m});
    }
};

class TileSource;

class PlacedTile {
  public:
    struct StoredRecord {
        float deviation = 0, radius = 0;  ///< metres
    };

    PlacedTile(const Tile& tile, const Placement& placement);
    /// The same tile placed anew: the same bits as from the Tile it was made of, if that came from a store. Closed
    /// diamonds stay closed; no tile below is known.
    PlacedTile(const PlacedTile& other, const Placement& placement);
    PlacedTile(PlacedTile&&) = default;

    /// Records by local index. The two cells of a diamond inside the tile share theirs: those of children do not lie
    /// side by side.
    class SplitRecords {
      public:
        SplitRecord operator[](std::size_t i) const { return by_vertex_[vertex_[i]]; }
        void prefetch(std::size_t i) const { __builtin_prefetch(&by_vertex_[vertex_[i]]); }

      private:
        friend class PlacedTile;
        std::vector<SplitRecord> by_vertex_;  // the root's corners have none
        const std::uint16_t* vertex_ = tile_layout().split_vertex.data();
    };
    /// What is known of the tiles below, by position at the level where they begin.
    class ChildBounds {
      public:
        /// Whether the store has no tile below this one.
        bool empty() const { return below_.empty(); }
        /// Whether the store has a tile below the cell at position k, 0..2^depth - 1.
        bool has(unsigned k) const { return (exists_[k >> 6] >> (k & 63) & 1) != 0; }
        /// A record that the root of that tile passes at most: where this one is not split, the cell is a leaf, and the
        /// tile need not be loaded to know it. Never split where there is none.
        SplitRecord operator[](unsigned k) const { return has(k) ? below_[index(k)].bound : SplitRecord{}; }
        /// Whether the store has a tile below local cell i, i < 2^(depth + 1).
        bool has_below(unsigned i) const { return i < 128 ? (any_[i >> 6] >> (i & 63) & 1) != 0 : has_any_of_word(i); }
        std::size_t size() const { return below_.size(); }
        /// How many tiles there are below before position k.
        std::size_t index(unsigned k) const {
            const std::uint64_t before = (std::uint64_t{1} << (k & 63)) - 1;
            return rank_[k >> 6] + static_cast<std::size_t>(std::popcount(exists_[k >> 6] & before));
        }

      private:
        friend class PlacedTile;
        // Local cell i with at most 64 cells at the level where tiles begin.
        bool has_any_of_word(unsigned i) const {
            const int levels = depth_ + 1 - static_cast<int>(std::bit_width(i));
            const unsigned first = (i << levels) - (1u << depth_);
            return (exists_[first >> 6] >> (first & 63) << (64 - (1u << levels))) != 0;
        }
        struct Below {
            SplitRecord bound{};
            StoredRecord stored;                      // not exaggerated
            mutable std::atomic<bool> known = false;  // whether the source has been asked
            mutable std::atomic<const PlacedTile*> tile = nullptr;
        };
        std::array<std::uint64_t, tile_cells / 64> exists_{};  // bit k
        std::array<std::uint16_t, tile_cells / 64> rank_{};    // how many there are before each 64 bits
        std::array<std::uint64_t, 2> any_{};                   // bit i: has_below(i), for cells of levels 0 to 6
        std::vector<Below> below_;                             // those that exist, ascending
        int depth_ = 0;                                        // the tile's
    };

    LocationCode root;
    int depth;
    SplitRecords split;  ///< by local index, 1 <= i < 2^depth
    ChildBounds child_bound;
    std::vector<GridPosition> position;  ///< by vertex index
    std::vector<float> height;           ///< by vertex index, metres above the datum, not exaggerated
    bool damaged;
    /// By relative level: no record has more than this deviation and this radius.
    std::array<StoredRecord, tile_levels> most{};

    /// Whether the diamond of local cell i can be split now, and whether it is one of the store at all.
    bool is_open(unsigned i) const { return split[i].deviation > 0; }
    bool is_stored(unsigned i) const { return split[i].deviation != 0; }
    /// Opens or closes a diamond of the store: changes the sign of its deviation. No walk may run meanwhile.
    void set_open(unsigned i, bool open) {
        float& deviation = split.by_vertex_[tile_layout().split_vertex[i]].deviation;
        deviation = std::copysign(deviation, open ? 1.0f : -1.0f);
    }
    /// Closes every diamond.
    void close();

    /// Whether the store has a tile below local cell i, i < 2^(depth + 1).
    bool has_child_below(unsigned i) const { return child_bound.has_below(i); }

    /// The position, among the cells where tiles below begin, of local cell i, 2^depth <= i < 2^(depth + 1).
    unsigned position_below(unsigned i) const { return i - (1u << depth); }
    /// The tile below the cell at position k, or nullptr if there is none: asked of the source once.
    const PlacedTile* child(const TileSource& source, unsigned k) const {
        return child_bound.has(k) ? child_at(source, k) : nullptr;
    }
    /// The same, but only if its root may pass the test.
    template <class Test>
    const PlacedTile* child(const TileSource& source, unsigned k, const Test& test) const {
        return child_bound.has(k) && test(child_bound[k]) ? child_at(source, k) : nullptr;
    }
    /// Says what the answer is, nullptr or the tile, before it is asked for or from now on. No walk may run meanwhile.
    /// @param k with child_bound.has(k)
    void set_child(unsigned k, const PlacedTile* tile);
    /// Says of every tile below that it is not there.
    void set_no_children();

    /// Memory of the tile.
    std::size_t bytes() const;

  private:
    void note_children(const Tile& tile);
    StoredRecord stored(std::size_t vertex) const;
    void place(const Placement& placement);
    void place_records(std::span<const glm::vec3> rounded, const Placement& placement);
    void bound_children(std::span<const glm::vec3> rounded, const Placement& placement);
    const PlacedTile* child_at(const TileSource& source, unsigned k) const;

    std::vector<float> undulation_;  // by vertex index, metres: exact for tiles of stores. Empty: 0
    std::vector<StoredRecord>
        stored_;  // not exaggerated, by vertex index; empty where the records themselves are as stored
};

/// The unit normals of a tile's lattice vertices, by vertex index, `depth` levels deep.
std::vector<glm::dvec3> tile_normals(LocationCode root, int depth);

/// Where the walk gets its tiles. Answers must stay valid while the walk's result is being made.
class TileSource {
  public:
    virtual ~TileSource() = default;
    /// Where they begin.
    virtual TileLayers layers() const { return {}; }
    /// The tile whose root is this cell, or nullptr if there is none. @param root of a level at which tiles begin
    virtual const PlacedTile* tile(LocationCode root) const = 0;
};

}  // namespace planet
