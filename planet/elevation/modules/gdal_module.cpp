// The module octaglobe_gdal: elevation files through GDAL.

#include <gdal_priv.h>

#include <algorithm>

#include "planet/elevation/modules/gdal_crs.h"
#include "planet/elevation/modules/gdal_messages.h"
#include "planet/elevation/raster_io.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr const char* one_band = "one band of heights with a georeference, e.g. a GeoTIFF";
constexpr double unbelievable_m = 1e6;  // farther from 0 than any relief: an unmarked fill value

using Dataset = std::unique_ptr<GDALDataset, void (*)(GDALDataset*)>;

Dataset open(const std::string& path, const GdalMessages& messages) {
    Dataset dataset(static_cast<GDALDataset*>(
                        GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr)),
                    [](GDALDataset* d) { GDALClose(d); });
    if (!dataset) throw Error(Fault::bad_data, path, "cannot be read: " + messages.last(), one_band);
    return dataset;
}

std::string subdatasets(GDALDataset& dataset) {
    std::string names;
    char** list = dataset.GetMetadata("SUBDATASETS");
    for (int i = 0; list && list[i]; ++i) {
        const std::string entry = list[i];
        const auto at = entry.find("_NAME=");
        if (at == std::string::npos || names.size() > 300) continue;
        if (!names.empty()) names += ' ';
        names.append(entry, at + 6);
    }
    return names;
}

// The band of heights. Pictures are refused with a word of what they are.
GDALRasterBand& height_band(GDALDataset& dataset, const std::string& path) {
    const int n = dataset.GetRasterCount();
    if (n == 0) {
        const std::string names = subdatasets(dataset);
        throw Error(Fault::bad_data, path, names.empty() ? "has no band" : "holds several rasters",
                    names.empty() ? one_band : "one of " + names);
    }
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    const bool alpha = n == 2 && dataset.GetRasterBand(2)->GetColorInterpretation() == GCI_AlphaBand;
    if (n > 1 && !alpha) {
        const bool colour = band.GetColorInterpretation() == GCI_RedBand;
        throw Error(Fault::bad_data, path,
                    "has " + std::to_string(n) + " bands" + (colour ? ": a colour picture, not elevation" : ""),
                    one_band);
    }
    // GDAL gives every band of one bit a palette of black and white: such a mask is values all the same.
    const char* bits = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
    const bool one_bit = bits && std::string_view(bits) == "1";
    if (band.GetColorInterpretation() == GCI_PaletteIndex && !one_bit)
        throw Error(Fault::bad_data, path, "holds palette colours, not elevation", one_band);
    if (GDALDataTypeIsComplex(band.GetRasterDataType()))
        throw Error(Fault::bad_data, path, "holds complex numbers", one_band);
    return band;
}

bool fits_longitude_latitude(const Raster& r) {
    for (const double column : {-0.5, r.width - 0.5})
        for (const double row : {-0.5, r.height - 0.5}) {
            const glm::dvec2 p = r.grid.crs_from_sample({column, row});
            const glm::dvec2 half = 0.51 * (glm::abs(r.grid.per_column) + glm::abs(r.grid.per_row));
            if (p.x < -180 - half.x || p.x > 360 + half.x || std::abs(p.y) > 90 + half.y) return false;
        }
    return true;
}

// False if the file has none that is of use.
bool read_grid(GDALDataset& dataset, Raster& raster) {
    double g[6];
    if (dataset.GetGeoTransform(g) != CE_None) return false;
    raster.grid = {{g[0] + 0.5 * (g[1] + g[2]), g[3] + 0.5 * (g[4] + g[5])}, {g[1], g[4]}, {g[2], g[5]}};
    const glm::dvec2 last = raster.grid.crs_from_sample({raster.width, raster.height});
    return std::isfinite(last.x + last.y) && std::abs(raster.grid.determinant()) > 0;
}

void read_georeference(GDALDataset& dataset, const RasterOptions& options, const std::string& path, Raster& raster) {
    if (!read_grid(dataset, raster)) {
        if (!options.plain)
            throw Error(Fault::bad_data, path, "has no georeference (or only control points)", one_band);
        raster.grid = {{0, 0}, {1, 0}, {0, -1}};
        raster.plain = true;
        return;
    }
    const OGRSpatialReference* named = dataset.GetSpatialRef();
    OGRSpatialReference crs;
    if (named && !named->IsEmpty() && !named->IsLocal()) {
        crs = *named;
    } else if (!options.crs_if_missing.empty()) {
        if (crs.SetFromUserInput(options.crs_if_missing.c_str()) != OGRERR_NONE)
            throw Error(Fault::bad_usage, options.crs_if_missing, "is no CRS", "e.g. EPSG:32633");
    } else if (options.plain) {
        raster.plain = true;
        return;
    } else if (fits_longitude_latitude(raster)) {
        crs.SetWellKnownGeogCS("WGS84");
    } else {
        throw Error(Fault::bad_data, path, "does not name its CRS", one_band);
    }
    try {
        set_crs(raster, crs, path);
    } catch (const Error&) {
        if (!options.plain) throw;
        raster.crs.clear();
        raster.radius_m = Raster().radius_m;
        raster.plain = true;
    }
}

// Metres in a unit of the band: by the band's unit, else by the vertical part of the CRS.
double metres_per_unit(GDALDataset& dataset, GDALRasterBand& band) {
    const std::string unit = CPLString(band.GetUnitType()).tolower();
    if (unit == "us-ft" || unit == "ftus" || unit == "us survey foot" || unit == "us survey feet") return 1200.0 / 3937;
    if (unit == "ft" || unit == "foot" || unit == "feet") return 0.3048;
    if (unit == "km") return 1000;
    if (unit == "cm") return 0.01;
    if (!unit.empty()) return 1;
    return metres_per_height(dataset.GetSpatialRef());
}

int reduction_for(int width, int height, const RasterOptions& options, const std::string& path) {
    const auto size = [&](int n) { return std::int64_t{width / n} * std::int64_t{height / n}; };
    if (size(1) <= options.max_samples) return 1;
    const std::string text = std::to_string(width) + "x" + std::to_string(height);
    if (!options.reduce)
        throw Error(Fault::bad_data, path, text + " samples are too many",
                    "at most " + std::to_string(options.max_samples) + " samples; cut or reduce it");
    int n = 3;
    while (size(n) > options.max_samples && n < std::min(width, height) - 2) n += 2;
    if (size(n) > options.max_samples) throw Error(Fault::bad_data, path, text + " samples cannot be reduced enough");
    return n;
}

// Reads rows and turns them into marked samples, in pieces of about a million.
class SampleReader {
  public:
    SampleReader(GDALRasterBand& band, int reduction, const std::string& path, const GdalMessages& messages)
        : band_(band), reduction_(reduction), path_(path), messages_(messages) {
        int has = 0;
        nodata_ = band.GetNoDataValue(&has);
        has_nodata_ = has != 0;
        masked_ = (band.GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0;
    }

    void read(Raster& raster) {
        const GDALDataType type = band_.GetRasterDataType();
        const bool small = type == GDT_Byte || type == GDT_Int16 || type == GDT_UInt16;
        if (small && read_all<std::int32_t, std::int16_t>(raster, GDT_Int32)) return;
        if (small || type == GDT_Float32)
            read_all<float, float>(raster, GDT_Float32);
        else
            read_all<double, float>(raster, GDT_Float64);
    }

  private:
    // False if a value does not fit the storage.
    template <class Read, class Stored>
    bool read_all(Raster& raster, GDALDataType type) {
        const int w = raster.width;
        const int rows_at_once = std::max(1, (1 << 20) / w);
        std::vector<Stored> samples(raster.count());
        std::vector<Read> piece(static_cast<std::size_t>(w) * static_cast<std::size_t>(rows_at_once));
        bool any = false;
        for (int row = 0; row < raster.height; row += rows_at_once) {
            const int rows = std::min(rows_at_once, raster.height - row);
            fetch(band_, row, w, rows, piece.data(), type);
            if (masked_) {
                mask_.resize(piece.size());
                fetch(*band_.GetMaskBand(), row, w, rows, mask_.data(), GDT_Byte);
            }
            const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(rows);
            Stored* out = samples.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(w);
            if (!convert(raster, piece.data(), n, out, any)) return false;
        }
        if (!any) throw Error(Fault::bad_data, path_, "holds no heights: every sample is nodata", one_band);
        raster.samples = std::move(samples);
        return true;
    }

    void fetch(GDALRasterBand& band, int row, int w, int rows, void* out, GDALDataType type) {
        const int n = reduction_;
        if (band.RasterIO(GF_Read, 0, row * n, w * n, rows * n, out, w, rows, type, 0, 0, nullptr) != CE_None)
            throw Error(Fault::bad_data, path_, "is damaged or cut short: " + messages_.last(), one_band);
    }

    bool convert(const Raster& raster, const std::int32_t* in, std::size_t n, std::int16_t* out, bool& any) const {
        const bool integral = has_nodata_ && nodata_ == std::floor(nodata_) && std::abs(nodata_) < 1e6;
        const std::int32_t nodata = integral ? static_cast<std::int32_t>(nodata_) : std::numeric_limits<int>::min();
        std::int32_t least = 0, greatest = 0;
        bool valid_seen = false;
        for (std::size_t i = 0; i < n; ++i) {
            const bool valid = in[i] != nodata && (!masked_ || mask_[i] != 0);
            const std::int32_t v = valid ? in[i] : 0;
            valid_seen |= valid;
            least = std::min(least, v);
            greatest = std::max(greatest, v);
            out[i] = valid ? static_cast<std::int16_t>(v) : void_sample;
        }
        any |= valid_seen;
        const double metres = std::max(std::abs(least * raster.scale), std::abs(greatest * raster.scale));
        return least > water_sample && greatest <= 32767 && metres + std::abs(raster.offset) <= unbelievable_m;
    }

    template <class Read>
    bool convert(const Raster& raster, const Read* in, std::size_t n, float* out, bool& any) const {
        const Read nodata = static_cast<Read>(nodata_);  // a float file's nodata is the float nearest to what it says
        for (std::size_t i = 0; i < n; ++i) {
            const double metres = raster.offset + raster.scale * static_cast<double>(in[i]);
            const bool valid =
                std::abs(metres) <= unbelievable_m && !(has_nodata_ && in[i] == nodata) && (!masked_ || mask_[i] != 0);
            out[i] = valid ? static_cast<float>(in[i]) : std::numeric_limits<float>::quiet_NaN();
            any |= valid;
        }
        return true;
    }

    GDALRasterBand& band_;
    int reduction_;
    const std::string& path_;
    const GdalMessages& messages_;
    double nodata_ = 0;
    bool has_nodata_ = false, masked_ = false;
    std::vector<std::uint8_t> mask_;
};

class GdalDriver : public RasterDriver {
  public:
    GdalDriver() {
        const GdalMessages quiet;
        GDALAllRegister();
    }

    Raster read(const std::string& path, const RasterOptions& options, std::vector<std::string>& files) const override {
        const GdalMessages messages;
        const Dataset dataset = open(path, messages);
        GDALRasterBand& band = height_band(*dataset, path);
        Raster raster;
        const int n = reduction_for(band.GetXSize(), band.GetYSize(), options, path);
        raster.width = band.GetXSize() / n;
        raster.height = band.GetYSize() / n;
        raster.reduction = n;
        read_georeference(*dataset, options, path, raster);
        raster.grid.origin = raster.grid.crs_from_sample(glm::dvec2(0.5 * (n - 1)));
        raster.grid.per_column *= n;
        raster.grid.per_row *= n;
        const double unit = metres_per_unit(*dataset, band);
        raster.scale = band.GetScale() * unit;
        raster.offset = band.GetOffset() * unit;
        if (!std::isfinite(raster.scale) || raster.scale == 0 || !std::isfinite(raster.offset))
            throw Error(Fault::bad_data, path, "has no usable scale and offset");
        SampleReader(band, n, path, messages).read(raster);
        if (char** list = dataset->GetFileList()) {
            for (int i = 0; list[i]; ++i) files.emplace_back(list[i]);
            CSLDestroy(list);
        }
        return raster;
    }

    std::string version() const override { return std::string("GDAL ") + GDALVersionInfo("RELEASE_NAME"); }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::RasterDriver* octaglobe_gdal_2() {
    static const planet::GdalDriver driver;
    return &driver;
}
