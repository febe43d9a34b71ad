#pragma once

#include "planet/lanes.h"

namespace planet {

/// Planes of cells, one a lane: see CellPlane.
struct LanePlane {
    Lanes corner[3], normal[3];

    /// t of deviation.h is over() / under().
    Lanes over(const Lanes* point) const {
        return (corner[0] - point[0]) * normal[0] + (corner[1] - point[1]) * normal[1] +
               (corner[2] - point[2]) * normal[2];
    }
    Lanes under(const Lanes* n) const { return n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2]; }
};

}  // namespace planet
