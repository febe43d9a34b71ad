#pragma once
// How a TIN comes about, as a sheet of panels: the raster as grey relief, then for each number of triangles asked for
// the triangulation over the deviations that were there before its last insertion, so that the new vertex, in a ring,
// sits on the brightest spot (Raudins, "Iterative TIN"). It is painted without OpenGL.

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "planet/elevation/image.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/make_tin.h"

namespace render {

/// Numbers of triangles, as the paper has them.
inline const std::vector<std::size_t> paper_stages{50, 150, 250, 450, 750, 1050};

inline constexpr std::size_t most_stages = 35;

/// From a column to the next and from a row to the next, near the middle of the raster.
glm::dvec2 metres_per_sample(const planet::RasterFrame& source);

/// Inserts strictly in order up to the largest stage, or until the tolerance of the options is kept, and paints what it
/// passes through.
/// @param shape metres_per_sample(), for the panels' proportions
/// @param options measure, metric, features and tolerance count; quality does not
/// @param stages each 3 or more, in any order, at most most_stages; there are as many triangles or one less
/// Throws planet::Error: bad_usage for stages out of range, or if there is none on the way.
planet::Image draw_tin_steps(const planet::HeightGrid& grid, glm::dvec2 shape, planet::TinOptions options,
                             std::vector<std::size_t> stages);

/// The same to a file: .png, .jpg or .tif.
void write_tin_steps(const planet::HeightGrid& grid, glm::dvec2 shape, const planet::TinOptions& options,
                     const std::vector<std::size_t>& stages, const std::string& path);

}  // namespace render
