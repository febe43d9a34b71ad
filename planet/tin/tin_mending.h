#pragma once
// More samples for a TIN that is made, however it was: as one, or in tiles. Only the triangles around them change.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/tin/height_grid.h"
#include "planet/tin/tin_mesh.h"
#include "planet/tin/written_tin.h"

namespace planet {

struct MendedTin {
    std::size_t inserted = 0;            ///< samples
    std::vector<std::uint32_t> changed;  ///< triangles that have changed or are new, ascending
};

/// Puts the samples of triangles in. Triangles keep their numbers, those that change too; new ones come after them, and so
/// do vertices. A sample is left out if its triangle has changed for one before it: it should be measured first.
/// Made anew from its vertices, a mesh gets other diagonals wherever four of them lie on a circle and where tiles met; each
/// of those may be too far off in turn. So only what is around the samples is linked, some thousands of them at a time.
/// @param grid whose heights the vertices get @param due ascending by triangle; each sample in its triangle, on a side or
/// within, but at no corner
MendedTin mend(TinMesh& mesh, const HeightGrid& grid, std::span<const FarTriangle> due);

}  // namespace planet
