#include "planet/elevation/grid_writer.h"

#include <cstdio>

#include "planet/elevation/module.h"

namespace planet {
namespace {

const GridDriver& driver() {
    using Factory = const GridDriver* (*)();
    static const GridDriver* const found = reinterpret_cast<Factory>(
        module_symbol("octaglobe_gdal", "octaglobe_gdal_grids_1", "writing GeoTIFF and GeoJSON files"))();
    return *found;
}

}  // namespace

std::string azimuthal_equidistant_crs(double latitude, double longitude) {
    char text[200];
    std::snprintf(text, sizeof text, "+proj=aeqd +lat_0=%.12g +lon_0=%.12g +datum=WGS84 +units=m +no_defs", latitude,
                  longitude);
    return text;
}

std::string geotiff_of(const ClassGrid& grid) {
    return driver().geotiff(grid);
}

std::string geojson_of(const ClassGrid& grid, std::uint8_t value) {
    return driver().geojson(grid, value);
}

}  // namespace planet
