#pragma once
// Normals of meshes of rasters, for formats that hold them.

#include <vector>

#include "planet/mesh/surface_mesh.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/height_grid.h"

namespace render {

/// Of unit length, by vertex: those of the triangles around it, by their areas.
std::vector<glm::vec3> normals_of(const planet::SurfaceMesh& mesh);

/// Of the ground at samples, from those up to ground_reach away: the same bits from any window that has them.
/// @param frame of the grid's window
std::vector<glm::vec3> ground_normals(const planet::HeightGrid& grid, const planet::RasterFrame& frame,
                                      const std::vector<glm::ivec2>& samples);

/// How far away samples tell ground_normals().
inline constexpr int ground_reach = 8;

}  // namespace render
