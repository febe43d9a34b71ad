#pragma once
// More samples for a TIN that is made, however it was: as one, or in tiles. Only the triangles around them change.

#include <cstdint>
#include <vector>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Triangles keep their numbers, those that change too; new ones come after them, and so do vertices.
/// Made anew from its vertices, a mesh gets other diagonals wherever four of them lie on a circle and where tiles met; each
/// of those may be too far off in turn.
class TinMending {
  public:
    explicit TinMending(TinMesh mesh);

    /// @param triangle that holds the sample, on a side or within, but at no corner
    /// @return false, and nothing is done, if the triangle has changed since take_changed(): it should be measured first
    bool insert(glm::ivec2 sample, std::uint32_t triangle);

    /// Triangles that have changed or are new since the last call, ascending.
    std::vector<std::uint32_t> take_changed();

    /// @param grid whose heights the vertices get
    TinMesh mesh(const HeightGrid& grid) const;

  private:
    void hold(const std::vector<std::array<glm::ivec2, 2>>& sides);

    Delaunay mesh_;
    std::vector<std::uint32_t> changed_;
    std::vector<std::uint8_t> has_changed_;  ///< by triangle
};

}  // namespace planet
