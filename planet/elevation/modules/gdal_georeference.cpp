// Of the module octaglobe_gdal: where pictures lie.

#include <gdal_priv.h>

#include "planet/elevation/georeference.h"
#include "planet/elevation/modules/gdal_crs.h"
#include "planet/elevation/modules/gdal_messages.h"
#include "planet/error.h"

namespace planet {
namespace {

bool read_header(const char* path, RasterHeader& header) {
    const GdalMessages quiet;
    GDALAllRegister();
    const std::unique_ptr<GDALDataset, void (*)(GDALDataset*)> dataset(
        static_cast<GDALDataset*>(GDALOpenEx(path, GDAL_OF_RASTER, nullptr, nullptr, nullptr)),
        [](GDALDataset* d) { GDALClose(d); });
    if (!dataset) return false;
    header.width = dataset->GetRasterXSize();
    header.height = dataset->GetRasterYSize();
    if (!read_grid(*dataset, header)) return false;
    header.plain = true;
    const OGRSpatialReference* named = dataset->GetSpatialRef();
    if (!named || named->IsEmpty() || named->IsLocal()) return true;
    try {
        OGRSpatialReference crs = *named;
        set_crs(header, crs, path);
        header.plain = false;
    } catch (const Error&) {
        header.crs.clear();
    }
    return true;
}

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) bool octaglobe_gdal_georeference_1(const char* path,
                                                                                     planet::RasterHeader* header) {
    return planet::read_header(path, *header);
}
