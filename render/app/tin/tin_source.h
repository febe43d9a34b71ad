#pragma once
// The rasters of `octaglobe tin` as one, its frame, and what is cut out of it.

#include <memory>
#include <string>
#include <vector>

#include "planet/elevation/features.h"
#include "planet/elevation/raster_mosaic.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/tin_features.h"
#include "render/app/tin/tin_options.h"

namespace render {

class TinSource {
  public:
    /// Opens the files and reads the masks. Throws planet::Error(bad_data) for what is missing, no DEM, or not on the grid
    /// of the first, and for masks without polygons.
    explicit TinSource(const TinCommand& command);

    /// Without samples.
    const std::shared_ptr<const planet::Raster>& raster() const { return raster_; }
    planet::VerticalDatum datum() const;

    /// All heights, masked; what was kept of the files is let go. Throws planet::Error(bad_data) if there are none, or too many for the memory of one mesh.
    planet::HeightGrid heights() const;
    /// A window of them. Safe from several threads. @param first, last sample, both included
    planet::HeightGrid heights(glm::ivec2 first, glm::ivec2 last) const;

    /// The frame of what is written. Throws planet::Error(bad_usage) if it does not reach all of the raster, or if the
    /// format does not hold it.
    planet::RasterFrame frame(planet::MeshFrame frame, planet::MeshFormat format) const;
    /// An enu frame of the same heights, whose plane TINs of frames that curve are made over.
    planet::RasterFrame tangent_frame() const;

    /// Points and lines of the files that the command names, at samples.
    planet::TinFeatures features() const;
    /// The samples of the first and the last row where it is a pole, of a raster in longitude and latitude: all of a row is
    /// one place.
    std::vector<glm::ivec2> pole_samples() const;

  private:
    const TinCommand& command_;
    std::unique_ptr<const planet::RasterMosaic> mosaic_;
    std::shared_ptr<const planet::Raster> raster_;
    std::vector<planet::Polygon> mask_;
};

/// What became of the features that a command names. @param outside of the raster
void report_features(const planet::FeatureReport& found, std::size_t outside, Report& report);

/// Whether a frame curves, so that deviations are not those of the lattice.
inline bool curves(const planet::RasterFrame& frame) {
    const planet::MeshFrame kind = frame.reference().frame;
    return !frame.affine() && (kind == planet::MeshFrame::enu || kind == planet::MeshFrame::ecef);
}

/// The share of a tolerance that is left to the curves of parallels and meridians, which the lattice has straight, in frames
/// that are not affine: of 20 m up to 9 mm were seen. What it does not cover is mended.
inline constexpr double curve_spare = 5e-4;

/// What heights above the plane of an enu frame must be kept within, of what is measured along the verticals of a raster:
/// the cosine of how far these lean, or 0.94 where that is less, and mending has to see to the rest.
double share_above_plane(const planet::RasterFrame& tangent, glm::ivec2 size);

/// About where a window of a raster lies in a frame: a box.
struct PlacedBox {
    glm::dvec3 low, high;
};
/// @param first, last sample of the window @param lowest, highest metres
PlacedBox box_of_window(const planet::RasterFrame& frame, glm::ivec2 first, glm::ivec2 last, double lowest,
                        double highest);

/// Lowest and highest valid height, metres; (+infinity, -infinity) if there is none.
glm::dvec2 height_range(const planet::HeightGrid& grid);

}  // namespace render
