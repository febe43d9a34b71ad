#pragma once
// How large cells are. Lengths are chords and areas plane triangles on the unit sphere: multiply by a radius (squared).

#include "planet/octahedron/location_code.h"

namespace planet {

struct CellMetrics {
    double split_min, split_max;  ///< the split side
    double side_min, side_max;    ///< all three sides: near an E_i a leg can be longer than the split side
    double area_min, area_max;
    double angle_min;       ///< rad, smallest angle of any cell
    double vertex_spacing;  ///< sqrt(4 pi / number of vertices): 11,292 km / 2^(level/2) on Earth
};

/// Measured over every cell of a level down to 15; below, where cells are flat, those of level 14 or 15 scaled by
/// powers of two (relative error below 1e-3). @param bisection_level 0..60
const CellMetrics& cell_metrics(int bisection_level);

/// The least bisection level whose mean vertex spacing is at most `spacing_m` on a sphere of that radius; 0..60.
int level_for_spacing(double spacing_m, double radius_m);

}  // namespace planet
