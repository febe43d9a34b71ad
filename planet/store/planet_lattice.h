#pragma once
// A store's lattice in memory, for meshes of the whole planet that are written rather than drawn.
//
// The deviations of a store are saturated: at least those of every diamond below, so that a view's test needs no closure.
// Where closure is at hand a cell may stay whole although a finer one inside it would have to be split, if only its *own*
// deviation is small. A tile without tiles below measures its own deviations exactly when it is loaded. The few others
// keep an interval for each cell, from the tile's own vertices up to the saturated number, and settle it only when a
// tolerance falls between, from those tiles below that can matter.

#include <bitset>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "planet/mesh/deviation.h"
#include "planet/mesh/placed_tile.h"
#include "planet/store/elevation_store.h"

namespace planet {

/// A tile reduced to what meshes are made of and measured with. 24 bytes a vertex.
struct LatticeTile {
    LocationCode root;
    int depth = 0;
    std::vector<float> height;      ///< by vertex index, metres above the store's datum
    std::vector<float> undulation;  ///< by vertex index, metres, of the datum above the ellipsoid; empty: 0
    /// By local index, metres: the cell's own deviation; 0 where its diamond does not exist. With tiles below: the part of
    /// it that this tile's vertices make, until it is settled.
    std::vector<float> deviation;
    /// A plane whose corners move by r metres moves by at most stretch r along the normals of the vertices in its cell:
    /// the largest over the tile's cells.
    float stretch = 1;

    struct Below {
        std::bitset<tile_cells> exists;  ///< by position at relative level `depth`
        std::vector<float> deviation;    ///< by position: saturated, of the root of the tile there
        std::vector<float> bound;        ///< by local index: not less than the cell's own deviation
        TileLattice lattice;             ///< this tile's
    };
    std::unique_ptr<Below> below;  ///< of a tile with tiles below it

    bool exists(unsigned local) const { return local >> depth == 0 && deviation[local] > 0; }
    /// An upper bound of own deviations. @param local below 2^depth
    float bound(unsigned local) const { return below ? below->bound[local] : deviation[local]; }
    double undulation_at(std::size_t v) const { return undulation.empty() ? 0.0 : static_cast<double>(undulation[v]); }
};

/// Memory to place a tile in, kept from one tile to the next.
struct LatticeScratch {
    TileLattice lattice;
    std::vector<GeoidUndulation> undulation;
    std::vector<std::uint8_t> exists;
};

/// The tiles that were asked for, each loaded once. For one thread, but load() works on several.
class PlanetLattice {
  public:
    /// @param store must outlive this @param threads 0: one for each processor
    /// Throws Error(bad_data) for a store that is not complete. Whatever reads a damaged tile throws Error(bad_data):
    /// what is written must not silently lack terrain.
    explicit PlanetLattice(const ElevationStore& store, unsigned threads = 0);

    const ElevationStore& store() const { return *store_; }
    TileLayers layers() const { return store_->metadata().layers; }
    const Placement& placement() const { return placement_; }
    unsigned threads() const { return threads_; }

    /// A tile if it has been loaded, else nullptr. @param root of a level at which tiles begin
    LatticeTile* find(LocationCode root) const;
    /// The tile, loaded if need be; nullptr if the store has none.
    LatticeTile* tile(LocationCode root);
    /// Loads tiles that are in the store, in parallel.
    void load(std::span<const LocationCode> roots);
    /// A tile of the store by itself, not kept, with saturated deviations: they say what exists. Safe to call from several
    /// threads.
    std::unique_ptr<LatticeTile> read(LocationCode root) const;

    /// Whether the cell's split vertex is in the store.
    bool exists(LocationCode cell);
    /// The finest cell that holds a direction.
    LocationCode finest_cell(const glm::dvec3& normal);
    /// A cell that the finest vertex nearest to a unit normal splits; std::nullopt for a corner of the octahedron.
    std::optional<LocationCode> nearest_split(const glm::dvec3& normal);
    /// The cell's own deviation, exactly: over every finest vertex in it, sides included; certified_deviation(). Metres.
    float own_deviation(LatticeTile& tile, unsigned local);

    /// The tile's vertices at their true heights; NaN for those that do not exist.
    void place(const LatticeTile& tile, LatticeScratch& scratch) const;

    std::size_t tile_count() const { return tiles_.size(); }

  private:
    struct Nearest;
    void search(LocationCode cell, const Corners& corners, Nearest& nearest);
    std::unique_ptr<LatticeTile> read_with_own_deviations(LocationCode root) const;
    float settle(const LatticeTile& tile, unsigned local);
    void raise_below(const LatticeTile& tile, unsigned first, unsigned end, const CellPlane& plane, float& worst);
    float bound_below(const LatticeTile& tile, unsigned position, const CellPlane& plane) const;

    const ElevationStore* store_;
    Placement placement_;
    unsigned threads_;
    std::unordered_map<std::uint64_t, std::unique_ptr<LatticeTile>> tiles_;
    LatticeScratch scratch_;
};

}  // namespace planet
