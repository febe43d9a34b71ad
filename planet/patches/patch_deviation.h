#pragma once
// The deviation of every cell of a raster, exactly: the largest vertical distance, metres, between the triangle through
// its corners and every sample in it, sides included; not only at the split vertex.
//
// Cells eight bisections above the finest are the lanes of a vector, eight at a time. Of their samples only the
// *residuals* (sample minus plane) are kept. Downwards those of a cell become its children's by one product each,
//
//     r_child(v) = r(v) - r(m) hat(v)          m the split vertex; hat linear, 1 at m and 0 at the child's other corners
//
// with the same weights in every cell of a depth, so no plane is ever set up. Upwards they are tested against the plane of
// every cell above while they are at hand: r(v) + (own plane - plane above)(v), a linear function. So each sample is
// loaded once; scanning large cells row by row, one level after the other, took twice as long, waiting for memory.
//
// Heights of whole metres make everything here dyadic, and the deviations exact; else they are rounded up to float after
// sums in double.

#include <functional>
#include <limits>

#include "planet/patches/patch_raster.h"
#include "planet/quadtree/dense_quadtree.h"

namespace planet {

/// Where valid and void samples mix: above any tolerance, so that such cells split down to unit cells.
inline constexpr float mixed_with_void = std::numeric_limits<float>::infinity();

/// By cell of bisection levels 0 .. lattice.bisection_levels() - 1 (unit cells have none). Cells of padding only, and
/// wholly void ones, have 0. Padding counts only by being void or not. The same bits whatever the threads.
/// @param threads 0: one a processor @param progress told 0..1, from any thread
DenseQuadtree<float> patch_deviations(const PatchRaster& raster, unsigned threads = 0,
                                      const std::function<void(double)>& progress = {});

}  // namespace planet
