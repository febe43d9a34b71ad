#pragma once
// Elevation tiles in a report.

#include "planet/streaming/resident_tiles.h"
#include "render/app/report.h"

namespace render {

/// tiles, tile_bytes, tiles_loaded, memory_limit_bytes, memory_peak_bytes.
void report_tiles(Report& report, const planet::ResidentCounts& counts);

}  // namespace render
