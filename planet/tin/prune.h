#pragma once
// What greedy insertion need not have inserted: vertices that can go without any sample getting farther than the
// tolerance.

#include <cstdint>
#include <vector>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"

namespace planet {

struct PruneOptions {
    double tolerance = 0;  ///< metres
    int passes = 1;        ///< over all vertices, or until one removes nothing
    /// By vertex: nonzero to keep it. May be shorter than there are vertices; those beyond may go.
    std::vector<std::uint8_t> keep = {};
};

/// Removes each vertex inside whose star, filled again, keeps the tolerance. The triangulation stays Delaunay.
/// @param mesh that keeps the tolerance @return vertices removed
std::size_t prune(Delaunay& mesh, const HeightGrid& grid, const PruneOptions& options);

}  // namespace planet
