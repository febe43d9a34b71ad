// Part of the module octaglobe_gdal: rasters are written.

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cassert>
#include <limits>

#include "planet/elevation/modules/gdal_messages.h"
#include "planet/elevation/raster_writer.h"
#include "planet/error.h"

namespace planet {
namespace {

class GdalSink : public RasterSink {
  public:
    GdalSink(const std::string& file, std::string shown_as, const RasterHeader& raster)
        : shown_as_(std::move(shown_as)) {
        const GdalMessages messages;
        GDALDriver* const tiff = GetGDALDriverManager()->GetDriverByName("GTiff");
        if (!tiff) fail("GDAL has no GeoTIFF");
        CPLStringList how;
        for (const char* option :
             {"TILED=YES", "COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=1", "BIGTIFF=IF_SAFER", "SPARSE_OK=TRUE"})
            how.AddString(option);
        dataset_.reset(tiff->Create(file.c_str(), raster.width, raster.height, 1, GDT_Float32, how.List()));
        if (!dataset_) fail(messages.last());
        const SampleGrid& g = raster.grid;
        const glm::dvec2 corner = g.crs_from_sample({-0.5, -0.5});
        double transform[]{corner.x, g.per_column.x, g.per_row.x, corner.y, g.per_column.y, g.per_row.y};
        dataset_->SetGeoTransform(transform);
        OGRSpatialReference crs;
        if (!raster.crs.empty() && crs.SetFromUserInput(raster.crs.c_str()) == OGRERR_NONE) {
            crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
            dataset_->SetSpatialRef(&crs);
        }
        dataset_->GetRasterBand(1)->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
        dataset_->GetRasterBand(1)->SetUnitType("m");
        check(messages);
    }

    ~GdalSink() override {
        const GdalMessages quiet;
        dataset_.reset();
    }

    void write(const SampleWindow& window, std::span<const float> samples) override {
        assert(samples.size() == window.count());
        const GdalMessages messages;
        const CPLErr done = dataset_->GetRasterBand(1)->RasterIO(
            GF_Write, window.column, window.row, window.columns, window.rows, const_cast<float*>(samples.data()),
            window.columns, window.rows, GDT_Float32, 0, 0, nullptr);
        if (done != CE_None) fail(messages.last());
        check(messages);
    }

    void close() override {
        const GdalMessages messages;
        dataset_.reset();  // what could not be written shows in messages only
        check(messages);
    }

  private:
    void check(const GdalMessages& messages) const {
        if (!messages.last().empty()) fail(messages.last());
    }
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(Fault::bad_usage, shown_as_, "cannot be written: " + why,
                    "a place with room for it, in a folder that can be written to");
    }

    const std::string shown_as_;
    std::unique_ptr<GDALDataset> dataset_;
};

class GdalSinks : public RasterSinkDriver {
  public:
    GdalSinks() { GDALAllRegister(); }
    std::unique_ptr<RasterSink> create(const std::string& file, const std::string& shown_as,
                                       const RasterHeader& raster) const override {
        return std::make_unique<GdalSink>(file, shown_as, raster);
    }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::RasterSinkDriver* octaglobe_gdal_sinks_1() {
    static const planet::GdalSinks driver;
    return &driver;
}
