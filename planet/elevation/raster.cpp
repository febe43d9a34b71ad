#include "planet/elevation/raster.h"

namespace planet {
namespace {

// Georeferences are often written with few digits: 1/12 degree as 0.083333. Ends may so be off by this many samples.
constexpr double slack = 0.02;

bool is_near(double a, double b) {
    return std::abs(a - b) <= slack;
}

PoleRow pole_row(double rows_beyond) {
    if (is_near(rows_beyond, 0.5)) return PoleRow::at_edge;
    if (is_near(rows_beyond, 0)) return PoleRow::at_row;
    return PoleRow::none;
}

}  // namespace

int columns_around(const RasterHeader& raster) {
    const SampleGrid& g = raster.grid;
    if (!raster.geographic() || g.per_column.y != 0 || g.per_row.x != 0 || g.per_column.x == 0) return 0;
    const double columns = 360 / std::abs(g.per_column.x);
    for (const int n : {raster.width, raster.width - 1})
        if (n >= 2 && is_near(columns, n)) return n;
    return 0;
}

Poles poles_of(const RasterHeader& raster) {
    const int around = columns_around(raster);
    if (around == 0 || around % 2 != 0 || raster.height < 2) return {};
    const double step = std::abs(raster.grid.per_row.y);
    const double first = raster.grid.origin.y;
    const double last = first + (raster.height - 1) * raster.grid.per_row.y;
    return {pole_row((90 - std::abs(first)) / step), pole_row((90 - std::abs(last)) / step)};
}

}  // namespace planet
