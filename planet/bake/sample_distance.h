#pragma once
// How far samples lie from the finest surface of one tile: what resampling lost there.
//
// Only the largest distance is wanted, so most samples need no exact one. With (u, v) the sample's place on the tile's
// lattice (tile_layout.h), found by central projection from the root's corners, its cell is a look-up, and the height
// of the surface there is nearly linear between the heights of the cell's corners. A sample that so lies nearer than the
// largest distance found by more than `slack` cannot exceed it. The others are measured exactly, as SurfaceCursor does;
// those so near to a side of a cell that the look-up may be wrong are located by descent from the root for that.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/mesh/deviation.h"
#include "planet/mesh/tile.h"

namespace planet {

/// One thread's; made to be used again and again.
class SampleDistance {
  public:
    /// Begins a tile. All arguments must outlive the last add().
    /// @param tile heights, undulations and root; @param lattice its normals and positions
    /// @param exists by local index @param covered by position at the tile's relative level `depth`, 1 where a tile
    /// below has the surface; empty: nowhere
    void start(const Placement& placement, const Tile& tile, const TileLattice& lattice,
               std::span<const std::uint8_t> exists, std::span<const std::uint8_t> covered);

    /// Takes samples: unit normals, and heights above the datum in metres. NaN and what is elsewhere or covered is
    /// skipped; a sample on a side of the root counts.
    void add(std::span<const glm::dvec3> normals, std::span<const float> heights);

    /// The largest |sample - surface| of the samples added, metres, rounded up; 0 if there was none.
    float largest() const;

    std::size_t measured_exactly() const { return exact_; }

  private:
    struct Piece;
    void place(std::span<const glm::dvec3> n, Piece& piece) const;
    void find_slack();
    void find_finest();
    double largest_bend() const;
    /// @param Number a double, or as many as fit a register; sum < 0 on the other side of the planet
    template <class Number>
    void place(const Number& x, const Number& y, const Number& z, Number& u, Number& v, Number& sum) const;
    unsigned finest_at(unsigned position) const;
    double estimate(unsigned local, double u, double v, float height) const;
    void add_in(unsigned local, const glm::dvec3& n, float height);
    void add_anywhere(const glm::dvec3& n, float height);
    unsigned finest_cell(const glm::dvec3& n) const;
    double surface(unsigned local, const glm::dvec3& n) const;

    const Placement* placement_ = nullptr;
    const Tile* tile_ = nullptr;
    const TileLattice* lattice_ = nullptr;
    std::span<const std::uint8_t> exists_, covered_;
    bool has_surface_ = false;
    bool whole_ = false, simple_ = false;  // every diamond exists; and no cell is covered
    bool counter_clockwise_ = false;
    std::vector<std::uint16_t> finest_;        // by position at relative level 12: local index, 0 if covered
    glm::dvec3 by_left_, by_right_, by_apex_;  // barycentric coordinates, but for a factor
    double bend_ = 0;                          // how far (u, v) of a lattice vertex may be from its place
    double slack_ = 0;                         // metres
    double largest_ = 0;
    std::size_t exact_ = 0;
};

}  // namespace planet
