#pragma once
// A line of samples as a polyline: what both sides of a border between tiles work out alike, from its samples alone.

#include <vector>

#include "planet/tin/tiled_tin.h"

namespace planet {

/// The samples to keep, their ends included, so that none deviates vertically from the straight line between those kept
/// on either side of it by more than the tolerance (Douglas and Peucker). Where valid and void samples meet, both are
/// kept. Of a stretch of voids no sample within is.
/// By a metric that adds up, a stretch may stay whose triangle would not be refined: one as high as it is long, in which
/// samples deviate as they do on the line.
/// @param line metres, NaN where void; at least two
/// @param keep places in the line that are kept whatever the heights, in any order
std::vector<int> simplified_line(const std::vector<float>& line, const TinBound& bound, std::vector<int> keep = {});

}  // namespace planet
