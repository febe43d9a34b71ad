#pragma once
// Which samples of a raster must stay vertices of its mesh.

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "planet/elevation/features.h"
#include "planet/patches/patch_raster.h"

namespace render {

struct KeptSamples {
    std::vector<glm::ivec2> samples;  ///< (column, row), each once, none void
    /// Points that are nowhere on the raster, or on a void sample, and pieces of lines that are not wholly on it.
    std::size_t outside = 0;
};

/// The samples nearest to points, and every sample that a line or the outline of a polygon passes.
/// @param features in the coordinates of the raster's grid
KeptSamples samples_on(const planet::Features& features, const planet::Raster& raster,
                       const planet::PatchRaster& patches);

/// The samples of the first and the last row where it is a pole, of a raster in longitude and latitude: there all of
/// a row is one place, and only triangles that no other sample lies in can tell how far they are from the terrain.
std::vector<glm::ivec2> samples_at_poles(const planet::Raster& raster);

}  // namespace render
