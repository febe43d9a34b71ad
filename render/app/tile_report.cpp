#include "render/app/tile_report.h"

namespace render {

void report_tiles(Report& report, const planet::ResidentCounts& counts) {
    report.set("tiles", counts.tiles);
    report.set("tile_bytes", counts.tile_bytes);
    report.set("tiles_loaded", counts.tiles_loaded);
    report.set("memory_limit_bytes", counts.memory_limit_bytes);
    report.set("memory_peak_bytes", counts.memory_peak_bytes);
}

}  // namespace render
