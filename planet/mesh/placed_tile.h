#pragma once
// A tile placed on its planet, ready for the walk: what the split test reads and the vertices it emits.

#include <atomic>
#include <memory>
#include <vector>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/grid.h"
#include "planet/mesh/tile.h"

namespace planet {

/// What one cell's split test reads: its split vertex (ecef, metres, at exaggerated height), deviation and radius.
/// Both cells of a diamond hold the same bits. deviation 0: never split.
struct SplitRecord {
    float x, y, z;
    float deviation;
    float radius;
};

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
    PlacedTile(const Tile& tile, const Placement& placement);

    LocationCode root;
    int depth;
    std::vector<SplitRecord> split;  ///< by local index, 2^depth
    /// By position at relative level 12: a record that the tile below passes at most: where this one is not split, the
    /// cell is a leaf, and the tile need not be loaded to know it. Empty if there are no tiles below.
    std::vector<SplitRecord> child_bound;
    std::vector<GridPosition> position;  ///< by vertex index
    std::vector<float> height;           ///< by vertex index, metres above the datum, not exaggerated
    bool damaged;

    /// The tile below the cell at relative level 12 and position k, or nullptr if there is none: asked of the source
    /// once.
    /// @param k 0..4095
    const PlacedTile* child(const TileSource& source, unsigned k) const;

    /// The same, but only if its root may pass the test.
    template <class Test>
    const PlacedTile* child(const TileSource& source, unsigned k, const Test& test) const {
        return !child_bound.empty() && test(child_bound[k]) ? child(source, k) : nullptr;
    }

    /// Whether the tile has a tile below its local cell i.
    bool has_child_below(unsigned i) const;

    std::size_t bytes() const {
        return sizeof *this + (split.size() + child_bound.size()) * sizeof(SplitRecord) +
               position.size() * sizeof(GridPosition) + height.size() * sizeof(float) +
               (children_ ? tile_cells * sizeof(children_[0]) : 0);
    }

  private:
    void bound_children(const Tile& tile, const std::vector<glm::vec3>& rounded, const Placement& placement);

    // By position: unknown until asked for (nullptr), known to be missing (this), or the tile.
    std::unique_ptr<std::atomic<const PlacedTile*>[]> children_;
};

/// The unit normals of a tile's lattice vertices, by vertex index, `depth` levels deep.
std::vector<glm::dvec3> tile_normals(LocationCode root, int depth);

/// Where the walk gets its tiles. Answers must stay valid while the walk's result is being made.
class TileSource {
  public:
    virtual ~TileSource() = default;
    /// The tile whose root is this cell, or nullptr if there is none. @param root bisection level a multiple of 12
    virtual const PlacedTile* tile(LocationCode root) const = 0;
};

}  // namespace planet
