#pragma once
// Frames in which meshes of rasters are written, and whether they reach.

#include <memory>
#include <string>

#include "planet/exporters/mesh_file.h"
#include "planet/patches/raster_frame.h"

namespace render {

/// The frame of a file whose user names none: enu for formats of lengths, else the raster's own.
planet::MeshFrame usual_frame(planet::MeshFormat format);

/// With the shipped geoid, where the frame needs it. Throws as planet::RasterFrame does.
planet::RasterFrame frame_of_raster(std::shared_ptr<const planet::Raster> raster, planet::MeshFrame frame,
                                    planet::VerticalDatum datum, double exaggeration = 1);

/// Whether RasterFrame::place() has found no place.
bool is_nowhere(const glm::dvec3& place);

/// Tries the raster's border. Throws planet::Error(bad_usage), as refuse_reach() does, if the frame does not reach it.
void check_reach(const planet::RasterFrame& frame, const planet::RasterHeader& raster);
/// @param raster its name
[[noreturn]] void refuse_reach(const std::string& raster);

}  // namespace render
