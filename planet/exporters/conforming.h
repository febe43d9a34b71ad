#pragma once
// Whether triangles from a file make up a conforming mesh: sides are shared whole, by one or two triangles that turn alike.

#include <optional>
#include <string>

#include "planet/exporters/mesh_file.h"

namespace planet {

/// The first thing that keeps a mesh from being one, with the numbers and places of the vertices concerned; nothing if
/// it is one:
///   a triangle with two corners at one vertex, or without area
///   a side of three triangles or more, or of two that turn unlike each other
///   two border sides at the same place (weld() joins them)
///   a border vertex within a border side (a T-junction), to 1.2e-7 of the mesh's extent, the rounding of floats
/// @param mesh with indices in range and finite coordinates, as read_mesh() leaves it
std::optional<std::string> conforming_fault(const SurfaceMesh& mesh);

/// Joins vertices whose coordinates are equal; the first one's attributes stay. Levels and strips are dropped.
/// @return how many vertices went
std::size_t weld(SurfaceMesh& mesh, MeshLooks& looks);

}  // namespace planet
