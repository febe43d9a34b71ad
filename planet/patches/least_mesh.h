#pragma once
// Which cells of a raster to split: for a bound, for a budget, for samples that must stay.

#include <cstdint>
#include <glm/glm.hpp>

#include "planet/patches/patch_deviation.h"
#include "planet/quadtree/triangulation.h"

namespace planet {

using PatchTriangulation = Triangulation<PatchGrid, DenseSplitSet>;

/// The roots only.
PatchTriangulation coarsest(const PatchRaster& raster);

/// Splits until no leaf deviates by more than the tolerance. Splits that the bound forces, and those that closure
/// forces after them, are in every conforming triangulation that keeps the bound and contains the given one: the result
/// is the least of these. (A threshold on saturated deviations, which most RTIN meshers use, also splits a cell that is
/// good enough if a finer one in it would not be.)
/// @param tolerance metres, >= 0
void refine_to_tolerance(PatchTriangulation& mesh, const DenseQuadtree<float>& deviation, double tolerance);

/// Splits leaves, worst first, as long as the mesh has at most max_triangles triangles (clipped to the raster, void
/// ones left out), and returns to the best state on the way: the least largest deviation, then the fewest triangles.
/// Every such state is the least mesh of its own largest deviation. @return false, and nothing changes, if the mesh
/// given has more
bool refine_to_budget(PatchTriangulation& mesh, const PatchRaster& raster, const DenseQuadtree<float>& deviation,
                      std::size_t max_triangles);

/// Splits every cell of a lesser bisection level. @param level 0 .. levels()
void refine_to_level(PatchTriangulation& mesh, int level);

/// Splits until the sample is a vertex. @param sample within the lattice
void keep_sample(PatchTriangulation& mesh, const PatchLattice& lattice, glm::ivec2 sample);

/// How many triangles a leaf becomes: 0 for padding and at void samples, 1 inside, up to 3 where the raster's border
/// cuts it.
std::size_t triangles_of_leaf(const PatchRaster& raster, const LatticeCorners& corners);

}  // namespace planet
