#pragma once
// The sum of the squared deviations of every cell of a raster, m^2: what a mesh's RMS deviation is made of. By one visit a
// cell, from its children: with residuals r (sample minus plane) and barycentric coordinates (l, r, a) of the child,
//
//     r_parent = r_child + d a        d = height of the split vertex - mean of its side's ends
//
// so the weighted sums of r^2, of r times a coordinate and of products of coordinates follow from those of the children,
// and no sample is visited twice. A sample weighs in a cell by the angle at which the cell meets it: 1 inside, 1/2 on a
// side, 1/4 or 1/8 at a corner, as a part of the angle within the raster. So the weights of children add up to those of
// the parent, and over the leaves of a conforming triangulation every sample weighs 1.

#include "planet/patches/least_mesh.h"

namespace planet {

/// By cell of bisection levels 0 .. lattice.bisection_levels() - 1 (unit cells have 0). Vertical deviations; padding and
/// void samples weigh nothing, cells with a void sample have 0. The same bits whatever the threads.
/// @param threads 0: one a processor
DenseQuadtree<double> patch_squared_deviations(const PatchRaster& raster, unsigned threads = 0);

/// Of the leaves of a conforming mesh: the sum over the raster's valid samples, each once, m^2. A leaf with a void sample
/// adds nothing.
double squared_deviation(const PatchTriangulation& mesh, const DenseQuadtree<double>& squared);

}  // namespace planet
