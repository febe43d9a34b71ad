#pragma once
// The parts of `octaglobe check`: each measures something and returns rows of figure, bound and whether it holds.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "planet/geodesy/accuracy.h"

namespace render {

/// What a part found. Throwing planet::Error instead says that a part could not be measured, which is a failure.
struct CheckPart {
    std::vector<planet::CheckRow> rows{};
    std::string skipped{};  ///< what is not measured because this machine has no means to, and why; empty: nothing
    std::string tables{};   ///< printed above all rows
};

/// Each file that SHA256SUMS in the data folder names: 0 if its content is what was shipped, 1 if not or if it is
/// missing, bound 0. Throws planet::Error(bad_data) if there is no data folder or no readable SHA256SUMS in it.
CheckPart check_data_files();

/// The planet-fixed grid of planet/mesh/grid.h: the worst a coordinate of about a million positions, from 11 km below
/// the ellipsoid to 2,000 km above it, is moved by putting it on the grid; and what taking it off again changes.
CheckPart check_grid();

/// The vertex shaders that pictures are drawn with, run on this machine's OpenGL and read back by transform feedback,
/// for eyes 1 m to 50,000 km up: coordinates that are not correctly rounded, the worst distance from the exact
/// position, metres, and the same in pixels of a 1920 x 1080 picture 40 degrees high, after projection. Skipped where
/// there is no OpenGL; a shader that OpenGL does not take is a failure.
CheckPart check_vertex_shaders();

/// Whole-planet meshes of the default Earth, in views over the poles, the antimeridian, the E_i and elsewhere: each is
/// a closed surface by planet::check. The Earth is baked if need be.
/// @param progress told of the baking
/// Throws planet::Error(bad_data) if the data cannot be read.
CheckPart check_meshes(const std::function<void(std::string_view step, double fraction)>& progress);

/// Only with --closure: what removing a vertex takes along, by experiment and by the formulas of
/// planet/quadtree/patch_lattice.h, for patches of 2^9 to 2^25 triangles: the worst case and the mean. Two tables.
CheckPart check_closure();

}  // namespace render
