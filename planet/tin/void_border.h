#pragma once
// Where valid samples end. A unit square with both valid and void corners gets all four as vertices: no circle through
// them holds another sample, so its two triangles are in every Delaunay triangulation of vertices that include them.
// All other triangles then have valid samples only, or void ones only, and the border of a hole follows the valid
// samples.

#include <vector>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Whether a sample is a corner of such a square.
bool on_void_border(const HeightGrid& grid, glm::ivec2 sample);

/// All such samples of a window, in rows. @param low, high its first and last sample
std::vector<glm::ivec2> void_border(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high);

/// The triangles of a triangulation that has all of them as vertices, without those over voids.
/// A square with three valid corners keeps the triangle between them. Vertices are numbered anew, in their order.
/// @param offset of the triangulation's coordinates in the raster
TinMesh triangles_over_samples(const Delaunay& mesh, const HeightGrid& grid, glm::ivec2 offset = {0, 0});

}  // namespace planet
