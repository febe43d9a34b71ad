#pragma once
// Greedy insertion to a tolerance, quickly: the sample inserted is always the worst of its triangle, and that triangle
// the worst of all to within a bucket of the queue.
//
// Triangles that an insertion makes are not scanned at once. They wait with the deviation of the triangle that held the
// inserted sample for a key, or a part of it, and are scanned when their turn comes; many are gone by then.

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"

namespace planet {

struct QuickInsertionOptions {
    double tolerance = 0;  ///< metres, >= 0
    /// The part of the deviation with which new triangles wait: 1 keeps closest to the greedy order; 1/2 scans a
    /// quarter fewer triangles and makes 2 to 4 % more, which pruning takes back.
    float patience = 1;
};

/// Inserts until no sample deviates by more than the tolerance, as measured in double, but never one on the border of
/// the grid.
/// @param mesh over the whole grid, whose border sides keep the tolerance (border_line.h)
void insert_to_tolerance(Delaunay& mesh, const HeightGrid& grid, const QuickInsertionOptions& options);

}  // namespace planet
