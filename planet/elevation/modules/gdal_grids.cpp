// Part of the module octaglobe_gdal: grids of classes as GeoTIFF and GeoJSON.

#include <cpl_vsi.h>
#include <gdal_alg.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <atomic>

#include "planet/elevation/grid_writer.h"
#include "planet/elevation/modules/gdal_messages.h"
#include "planet/error.h"

namespace planet {
namespace {

using Dataset = std::unique_ptr<GDALDataset, void (*)(GDALDataset*)>;

// A name in GDAL's memory that is free again in the end.
class MemoryFile {
  public:
    explicit MemoryFile(const char* ending) {
        static std::atomic<unsigned> count = 0;
        name_ = "/vsimem/octaglobe-" + std::to_string(++count) + ending;
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { VSIUnlink(name_.c_str()); }

    const char* name() const { return name_.c_str(); }
    std::string bytes() const {
        vsi_l_offset size = 0;
        const GByte* data = VSIGetMemFileBuffer(name_.c_str(), &size, FALSE);
        return data ? std::string(reinterpret_cast<const char*>(data), size) : std::string();
    }

  private:
    std::string name_;
};

[[noreturn]] void fail(const char* what, const GdalMessages& messages) {
    throw Error(Fault::bad_data, what, "GDAL cannot make it: " + messages.last());
}

Dataset create(const char* format, const char* name, const ClassGrid* grid, char** options,
               const GdalMessages& messages) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format);
    Dataset dataset(driver ? driver->Create(name, grid ? grid->width : 0, grid ? grid->height : 0, grid ? 1 : 0,
                                            grid ? GDT_Byte : GDT_Unknown, options)
                           : nullptr,
                    [](GDALDataset* d) { GDALClose(d); });
    if (!dataset) fail(format, messages);
    return dataset;
}

OGRSpatialReference crs_of(const ClassGrid& grid, const GdalMessages& messages) {
    OGRSpatialReference crs;
    if (crs.SetFromUserInput(grid.crs.c_str()) != OGRERR_NONE) fail("CRS", messages);
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

void fill(GDALDataset& dataset, const ClassGrid& grid, const GdalMessages& messages) {
    double transform[6] = {grid.top_left.x, grid.cell, 0, grid.top_left.y, 0, -grid.cell};
    const OGRSpatialReference crs = crs_of(grid, messages);
    // GDAL does not write to what it is given here.
    auto* cells = const_cast<std::uint8_t*>(grid.cells.data());
    if (dataset.SetGeoTransform(transform) != CE_None || dataset.SetSpatialRef(&crs) != CE_None ||
        dataset.GetRasterBand(1)->RasterIO(GF_Write, 0, 0, grid.width, grid.height, cells, grid.width, grid.height,
                                           GDT_Byte, 0, 0, nullptr) != CE_None)
        fail("grid", messages);
}

class GdalGridDriver : public GridDriver {
  public:
    GdalGridDriver() {
        const GdalMessages quiet;
        GDALAllRegister();
    }

    std::string geotiff(const ClassGrid& grid) const override {
        const GdalMessages messages;
        const MemoryFile file(".tif");
        const char* options[] = {"COMPRESS=DEFLATE", "TILED=YES", nullptr};
        {
            Dataset dataset = create("GTiff", file.name(), &grid, const_cast<char**>(options), messages);
            GDALRasterBand& band = *dataset->GetRasterBand(1);
            std::string names;
            for (const auto& each : grid.classes)
                names += (names.empty() ? "" : ", ") + std::to_string(each.value) + " " + each.name;
            band.SetNoDataValue(grid.outside);
            band.SetDescription(names.c_str());
            dataset->SetMetadataItem("TIFFTAG_IMAGEDESCRIPTION", grid.description.c_str());
            dataset->SetMetadataItem("TIFFTAG_SOFTWARE", "octaglobe");
            fill(*dataset, grid, messages);
            if (dataset->FlushCache(), !messages.last().empty()) fail("GeoTIFF", messages);
        }
        return file.bytes();
    }

    std::string geojson(const ClassGrid& grid, std::uint8_t value) const override {
        const GdalMessages messages;
        // Only cells of the value have a 1, and GDAL leaves the others out where the mask is 0.
        std::vector<std::uint8_t> of_value(grid.cells.size());
        for (std::size_t i = 0; i < of_value.size(); ++i) of_value[i] = grid.cells[i] == value;
        ClassGrid only = grid;
        only.cells = of_value;
        Dataset raster = create("MEM", "", &only, nullptr, messages);
        fill(*raster, only, messages);

        const MemoryFile file(".geojson");
        {
            Dataset vector = create("GeoJSON", file.name(), nullptr, nullptr, messages);
            OGRSpatialReference crs = crs_of(grid, messages);
            const char* options[] = {"RFC7946=YES", nullptr};
            OGRLayer* layer = vector->CreateLayer("viewshed", &crs, wkbPolygon, const_cast<char**>(options));
            OGRFieldDefn field("value", OFTInteger);
            if (!layer || layer->CreateField(&field) != OGRERR_NONE) fail("GeoJSON", messages);
            GDALRasterBand* band = raster->GetRasterBand(1);
            if (GDALPolygonize(band, band, OGRLayer::ToHandle(layer), 0, nullptr, nullptr, nullptr) != CE_None ||
                !messages.last().empty())
                fail("GeoJSON", messages);
        }
        return file.bytes();
    }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::GridDriver* octaglobe_gdal_grids_1() {
    static const planet::GdalGridDriver driver;
    return &driver;
}
