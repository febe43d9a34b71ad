#pragma once
// The parts of `octaglobe check`: each measures something and returns rows of figure, bound and whether it holds.

#include <vector>

#include "planet/geodesy/accuracy.h"

namespace render {

/// Each file that SHA256SUMS in the data folder names: 0 if its content is what was shipped, 1 if not or if it is
/// missing, bound 0. Throws planet::Error(bad_data) if there is no data folder or no readable SHA256SUMS in it.
std::vector<planet::CheckRow> check_data_files();

}  // namespace render
