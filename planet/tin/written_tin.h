#pragma once
// A TIN in the frame in which it is written, and what it achieves there.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/mesh/surface_mesh.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/tin_features.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Vertices placed in the frame, triangles counter-clockwise seen from above, strips over them. Level is 0 throughout.
/// @param grid whose heights the vertices get: not those the mesh was made with, if they were others
SurfaceMesh surface_from_tin(const TinMesh& mesh, const HeightGrid& grid, const RasterFrame& frame);

/// Heights to make a TIN from for a frame that curves (enu, ecef): above the plane that touches the ellipsoid at the
/// raster's middle. Between these and the plane of a triangle lies, to within the tilt of the verticals, what lies
/// between the samples and the triangle as written. @param frame an enu one @return metres, NaN where the frame does
/// not reach
HeightGrid heights_above_tangent_plane(const HeightGrid& grid, const RasterFrame& frame, unsigned threads = 0);

struct WrittenDeviation {
    double max = 0, rms = 0;           ///< metres, over the valid samples in triangles
    std::size_t samples = 0;           ///< valid ones in a triangle, each counted once
    std::size_t uncovered = 0;         ///< valid ones in none
    double angle_min = 0;              ///< smallest angle of the triangles as written, radians, x and y in metres
    std::vector<double> by_triangle;   ///< largest of each, metres
    std::vector<glm::ivec2> farthest;  ///< the sample of each that has it; -1 if none deviates
    /// On request: of each sample, in rows, metres, from the triangle that counts it; NaN where void or in no triangle.
    std::vector<float> by_sample;
};

/// The distance along the vertical of every sample of every triangle, sides included, from the plane through the
/// vertices as written, in metres of height: divided by the frame's exaggeration. A triangle whose corners are written
/// where their samples lie, in a frame that is affine, is measured in the lattice: exactly where heights are whole metres.
/// For the rms each sample counts once, in the first triangle that holds it.
/// @param written by vertex, in the frame, rounded as its format rounds
/// @param threads 0: one a processor. The same bits whatever the number.
WrittenDeviation measure_written(const TinMesh& mesh, std::span<const glm::dvec3> written, const HeightGrid& grid,
                                 const RasterFrame& frame, unsigned threads = 0, bool by_sample = false);

/// The TIN with more samples in it: what measure_written() finds too far, as one with curved sides or rounded vertices
/// may be. Triangles elsewhere may change too, where the mesh was not one Delaunay triangulation: measure again.
/// @param features that it was made with
TinMesh with_samples(const TinMesh& mesh, const HeightGrid& grid, std::span<const glm::ivec2> samples,
                     const TinFeatures& features);

}  // namespace planet
