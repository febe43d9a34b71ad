#pragma once
// The triangles of a triangulated raster, in the order of the curve: unique vertices, list and strip from one walk.

#include <array>
#include <cstdint>
#include <vector>

#include "planet/patches/clip.h"
#include "planet/patches/least_mesh.h"

namespace planet {

struct PatchMesh {
    std::vector<LatticeVertex> vertices;                  ///< unique, all used
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise in the lattice with y up, strip order
    std::vector<CellCode> cell;                           ///< by triangle: the leaf that it is (part of)
    std::vector<std::uint32_t> strip;                     ///< as in SurfaceMesh
};

/// Leaves at void samples are left out, those that cross the raster's border are cut. Patches are walked one after
/// the other, each along its own loop of the curve; the strip restarts between them, and where leaves are left out.
PatchMesh extract(const PatchTriangulation& mesh, const PatchRaster& raster);

/// Appends generalized strips over triangles that mostly share a side with the one before; restarts where not.
void append_strips(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::vector<std::uint32_t>& strip);

/// Turns strips over, so that they draw every triangle wound the other way: each begins with its first vertex twice.
void turn_strips(std::vector<std::uint32_t>& strip);

}  // namespace planet
