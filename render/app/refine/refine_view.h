#pragma once
// Selective refinement of a progressive mesh for an eye above a place.

#include "planet/bisection/progressive.h"
#include "render/app/refine/refine_base.h"
#include "render/app/refine/refine_options.h"

namespace render {

/// A side is split if it is longer than this share of its middle's distance from the eye: 1.1 degrees, 50 to 60 sides across
/// a picture.
inline constexpr double view_share = 0.02;

/// Where the eye is in the coordinates of a mesh: so far above the vertex nearest to the place.
/// Throws planet::Error(bad_usage) for a mesh whose coordinates are no known places on the Earth.
glm::dvec3 eye_of(const RefineView& view, const planet::Progressive& mesh, const RefineMeaning& meaning);

/// Whether a vertex's side looks longer than view_share from the eye.
bool seen_coarse(const planet::Progressive& mesh, planet::Progressive::Index vertex, const glm::dvec3& eye);

}  // namespace render
