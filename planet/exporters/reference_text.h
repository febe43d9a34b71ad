#pragma once
// What a file says of its coordinates, as lines "key value" in the comments of a text header.

#include <string>
#include <string_view>
#include <vector>

#include "planet/mesh/surface_mesh.h"

namespace planet {

/// "source", "utm", "enu" or "ecef".
std::string_view to_string(MeshFrame frame);

/// Of any other name, what `reference` had.
void set_frame(MeshReference& reference, std::string_view name);

/// In this order, those that are known; doubles read back to the same bits:
///   generator Octaglobe
///   frame enu
///   crs EPSG:4326               or WKT, on one line
///   vertical_datum EGM96
///   xy_unit degrees             only of geographic coordinates
///   origin_ecef X Y Z           of an enu frame, metres
///   ecef_from_enu ...           of an enu frame: east, north, up in ecef
std::vector<std::string> reference_lines(const MeshReference& reference);

/// Takes in one such line; one that is none changes nothing.
void read_reference_line(std::string_view line, MeshReference& reference);

}  // namespace planet
