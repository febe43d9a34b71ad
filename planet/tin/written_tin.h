#pragma once
// A TIN in the frame in which it is written, and what it achieves there.

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "planet/mesh/surface_mesh.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// Vertices placed in the frame, triangles counter-clockwise seen from above; no strips. Level is 0 throughout.
/// @param grid whose heights the vertices get: not those the mesh was made with, if they were others
SurfaceMesh surface_from_tin(const TinMesh& mesh, const HeightGrid& grid, const RasterFrame& frame);

/// Heights to make a TIN from for a frame that curves (enu, ecef): above the plane that touches the ellipsoid at the
/// raster's middle. Between these and the plane of a triangle lies, to within the tilt of the verticals, what lies
/// between the samples and the triangle as written. @param frame an enu one @return metres, NaN where the frame does
/// not reach
HeightGrid heights_above_tangent_plane(const HeightGrid& grid, const RasterFrame& frame, unsigned threads = 0);

/// A triangle with a sample too far from it.
struct FarTriangle {
    std::uint32_t triangle;
    glm::ivec2 sample;  ///< the farthest
    double deviation;   ///< metres
};

struct WrittenDeviation {
    double max = 0, rms = 0;           ///< metres, over the valid samples in triangles
    std::size_t samples = 0;           ///< valid ones in a triangle, each counted once
    std::size_t uncovered = 0;         ///< valid ones in none
    double angle_min = 0;              ///< smallest angle of the triangles as written, radians, x and y in metres
    std::vector<FarTriangle> too_far;  ///< beyond MeasureOptions::above, by triangle
    /// On request: of each sample, in rows, metres, from the triangle that counts it; NaN where void or in no triangle.
    std::vector<float> by_sample;
};

struct MeasureOptions {
    double above = std::numeric_limits<double>::infinity();  ///< metres: triangles that deviate by more are listed
    bool by_sample = false;
    unsigned threads = 0;  ///< 0: one a processor. The same bits whatever the number.
};

/// The distance along the vertical of every sample of every triangle, sides included, from the plane through the
/// vertices as written, in metres of height: divided by the frame's exaggeration. A triangle whose corners are written
/// where their samples lie, in a frame that is affine, is measured in the lattice: exactly where heights are whole metres.
/// For the rms each sample counts once, in the first triangle that holds it.
class WrittenMeasure {
  public:
    /// @param grid, frame stay as long as the measure
    WrittenMeasure(const HeightGrid& grid, const RasterFrame& frame, const MeasureOptions& options)
        : grid_(grid), frame_(frame), options_(options) {}

    /// @param written by vertex, in the frame, rounded as its format rounds
    void measure(const TinMesh& mesh, std::span<const glm::dvec3> written);
    /// The same, to the bit, of a mesh of which only some triangles are not as they were when it was last measured; next to
    /// no time where there are no voids. @param changed ascending
    void measure_again(const TinMesh& mesh, std::span<const glm::dvec3> written,
                       std::span<const std::uint32_t> changed);

    const WrittenDeviation& found() const { return found_; }
    WrittenDeviation take() { return std::move(found_); }

  private:
    struct Piece {
        double max = 0, squares = 0;
        double cotangent = 0;  ///< of the smallest angle
        std::size_t samples = 0;
        std::vector<FarTriangle> too_far;
    };

    template <class Holder>
    Piece measured(std::size_t piece, const TinMesh& mesh, std::span<const glm::dvec3> written, Holder& holder);
    void add_up();

    const HeightGrid& grid_;
    const RasterFrame& frame_;
    const MeasureOptions options_;
    std::vector<Piece> pieces_;  ///< so many triangles each
    WrittenDeviation found_;
};

/// As WrittenMeasure::measure() does.
WrittenDeviation measure_written(const TinMesh& mesh, std::span<const glm::dvec3> written, const HeightGrid& grid,
                                 const RasterFrame& frame, const MeasureOptions& options = {});

}  // namespace planet
