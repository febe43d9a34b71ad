#pragma once
// A TIN as the top of a solid, for printing: walls below its border, and a floor with the same border.

#include "planet/tin/tin_mesh.h"

namespace planet {

struct TinSolid {
    TinMesh top;
    std::vector<glm::ivec2> floor;  ///< samples below which the floor has vertices: numbered after those of the top
    /// Walls and floor, counter-clockwise seen from outside, with columns right and rows up.
    std::vector<std::array<std::uint32_t, 3>> below;
};

/// Every side has two triangles, which turn alike. A vertex at which the TIN touches itself (two holes that meet) becomes
/// one vertex for each part, at the same place: else four walls would meet below it.
/// @param mesh over a raster @param last its last sample (column, row)
TinSolid solid_below(TinMesh mesh, glm::ivec2 last);

}  // namespace planet
