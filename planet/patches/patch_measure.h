#pragma once
// What a written mesh of a raster has achieved: its deviation at every sample.

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/patches/patch_mesh.h"
#include "planet/patches/raster_frame.h"

namespace planet {

struct AchievedDeviation {
    double max = 0, rms = 0;          ///< metres
    std::size_t samples = 0;          ///< valid ones in a triangle, each counted once
    std::size_t uncovered = 0;        ///< valid ones in no triangle
    std::vector<double> by_triangle;  ///< largest in each, metres
};

/// Samples at their places in a frame that is not affine (RasterFrame): 36 bytes each.
struct PlacedSamples {
    std::vector<glm::dvec3> position;
    std::vector<glm::vec3> up;
};
/// @param progress told 0..1, from any thread
PlacedSamples place_samples(const PatchRaster& raster, const RasterFrame& frame,
                            const std::function<void(double)>& progress = {});

/// Places the vertices of a mesh.
std::vector<glm::dvec3> place_vertices(const PatchMesh& mesh, const RasterFrame& frame);

/// The distance along the vertical of each sample, from the plane of each triangle that holds it in the lattice, as the
/// vertices were written; from the nearest corner of a triangle that is no such plane, upright or without area. Each sample counts once for the rms: in the triangle a little to its right and above, or where
/// there may be none, in the first that holds it. The same bits whatever the threads.
/// @param written by vertex, in the frame, rounded as its format rounds @param samples of a frame that is not affine
/// @param progress told 0..1, from any thread
AchievedDeviation measure(const PatchMesh& mesh, std::span<const glm::dvec3> written, const PatchRaster& raster,
                          const RasterFrame& frame, const PlacedSamples* samples,
                          const std::function<void(double)>& progress = {});

}  // namespace planet
