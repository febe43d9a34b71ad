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

bool fits_longitude_latitude(const RasterHeader& r) {
    for (const double column : {-0.5, r.width - 0.5})
        for (const double row : {-0.5, r.height - 0.5}) {
            const glm::dvec2 p = r.grid.crs_from_sample({column, row});
            const glm::dvec2 half = 0.51 * (glm::abs(r.grid.per_column) + glm::abs(r.grid.per_row));
            if (p.x < -180 - half.x || p.x > 360 + half.x || std::abs(p.y) > 90 + half.y) return false;
        }
    return true;
}

void read_georeference(GDALDataset& dataset, const RasterOptions& options, const std::string& path,
                       RasterHeader& raster) {
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
        raster.radius_m = RasterHeader().radius_m;
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
    if (!options.reduce || size(1) <= options.max_samples) return 1;
    int n = 3;
    while (size(n) > options.max_samples && n < std::min(width, height) - 2) n += 2;
    if (size(n) > options.max_samples)
        throw Error(Fault::bad_data, path,
                    std::to_string(width) + "x" + std::to_string(height) + " samples cannot be reduced enough");
    return n;
}

// Windows of the height band as marked samples.
class GdalReader : public RasterReader {
  public:
    GdalReader(const std::string& path, const RasterOptions& options, const GdalMessages& messages)
        : path_(path), options_(options), dataset_(planet::open(path, messages)), band_(height_band(*dataset_, path)) {
        reduction_ = reduction_for(band_.GetXSize(), band_.GetYSize(), options, path);
        const double unit = metres_per_unit(*dataset_, band_);
        scale_ = band_.GetScale() * unit;
        offset_ = band_.GetOffset() * unit;
        if (!std::isfinite(scale_) || scale_ == 0 || !std::isfinite(offset_))
            throw Error(Fault::bad_data, path, "has no usable scale and offset");
        int has = 0;
        nodata_ = band_.GetNoDataValue(&has);
        has_nodata_ = has != 0;
        masked_ = (band_.GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0;
    }

    RasterHeader header() const override {
        const GdalMessages quiet;
        RasterHeader raster;
        const int n = reduction_;
        raster.width = band_.GetXSize() / n;
        raster.height = band_.GetYSize() / n;
        raster.reduction = n;
        raster.vertical_crs = vertical_of(dataset_->GetSpatialRef());
        read_georeference(*dataset_, options_, path_, raster);
        raster.grid.origin = raster.grid.crs_from_sample(glm::dvec2(0.5 * (n - 1)));
        raster.grid.per_column *= n;
        raster.grid.per_row *= n;
        raster.scale = scale_;
        raster.offset = offset_;
        return raster;
    }

    std::vector<std::string> files() const override {
        const GdalMessages quiet;
        std::vector<std::string> files;
        if (char** list = dataset_->GetFileList()) {
            for (int i = 0; list[i]; ++i) files.emplace_back(list[i]);
            CSLDestroy(list);
        }
        return files;
    }

    bool may_be_shorts() const override {
        const GDALDataType type = band_.GetRasterDataType();
        return type == GDT_Byte || type == GDT_Int16 || type == GDT_UInt16;
    }

    int natural_columns() const override { return natural_size().x; }
    int natural_rows() const override { return natural_size().y; }

    std::size_t decoded_bytes(int columns) const override {
        const auto [width, height] = std::pair(natural_columns(), natural_rows());
        const auto bytes = static_cast<std::size_t>(GDALGetDataTypeSizeBytes(band_.GetRasterDataType()));
        const std::string driver = dataset_->GetDriverName();
        if (driver == "VRT")
            if (const auto source = first_source()) return source->decoded_bytes(columns);
        const bool strips = width == band_.GetXSize();
        if (driver == "GTiff" && strips && !dataset_->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE")) return 0;
        const int rows = (columns + 2 * height - 2) / height * height;
        const int across = strips ? width : 2 * ((columns + 2 * width - 2) / width * width);
        return bytes * static_cast<std::size_t>(rows) * static_cast<std::size_t>(across);
    }

    bool read(const SampleWindow& window, std::span<std::int16_t> out) override {
        const GdalMessages messages;
        if (!may_be_shorts()) return false;
        if (band_.GetRasterDataType() == GDT_UInt16)
            return read_pieces<std::int32_t>(window, GDT_Int32, out.data(), messages);
        return read_pieces<std::int16_t>(window, GDT_Int16, out.data(), messages);
    }

    void read(const SampleWindow& window, std::span<float> out) override {
        const GdalMessages messages;
        if (may_be_shorts() || band_.GetRasterDataType() == GDT_Float32)
            read_pieces<float>(window, GDT_Float32, out.data(), messages);
        else
            read_pieces<double>(window, GDT_Float64, out.data(), messages);
    }

  private:
    // Of a virtual raster: one of the files that it is made of, null if there is none that can be opened.
    std::unique_ptr<GdalReader> first_source() const {
        const GdalMessages messages;
        for (const std::string& file : files())
            if (file != path_) try {
                    return std::make_unique<GdalReader>(file, options_, messages);
                } catch (const Error&) {
                    return nullptr;
                }
        return nullptr;
    }

    glm::ivec2 natural_size() const {
        glm::ivec2 size(0);
        band_.GetBlockSize(&size.x, &size.y);
        return size;
    }

    // At most about a million samples at a time. False if a value does not fit the storage.
    template <class Read, class Stored>
    bool read_pieces(const SampleWindow& window, GDALDataType type, Stored* out, const GdalMessages& messages) {
        const int rows_at_once = std::clamp((1 << 20) / window.columns, 1, window.rows);
        SampleWindow piece = window;
        for (; piece.row < window.row + window.rows; piece.row += rows_at_once) {
            piece.rows = std::min(rows_at_once, window.row + window.rows - piece.row);
            Read* read = nullptr;
            if constexpr (std::is_same_v<Read, Stored>) {
                read = out;  // turned into samples where they lie
            } else {
                buffer_.resize(piece.count() * sizeof(Read));
                read = reinterpret_cast<Read*>(buffer_.data());
            }
            fetch(band_, piece, read, type, messages);
            if (masked_) {
                mask_.resize(piece.count());
                fetch(*band_.GetMaskBand(), piece, mask_.data(), GDT_Byte, messages);
            }
            if (!convert(read, piece.count(), out)) return false;
            out += piece.count();
        }
        return true;
    }

    void fetch(GDALRasterBand& band, const SampleWindow& w, void* out, GDALDataType type,
               const GdalMessages& messages) const {
        if (can_read(band, w, out, type)) return;
        SampleWindow bad = w;
        bad.rows = 1;
        while (bad.row < w.row + w.rows - 1 && can_read(band, bad, out, type)) ++bad.row;
        throw Error(Fault::bad_data, path_,
                    "is damaged or cut short in row " + std::to_string(bad.row) + ", columns " +
                        std::to_string(w.column) + " to " + std::to_string(w.column + w.columns - 1) +
                        (messages.last().empty() ? "" : ": ") + messages.last(),
                    one_band);
    }

    bool can_read(GDALRasterBand& band, const SampleWindow& w, void* out, GDALDataType type) const {
        const int n = reduction_;
        return band.RasterIO(GF_Read, w.column * n, w.row * n, w.columns * n, w.rows * n, out, w.columns, w.rows, type,
                             0, 0, nullptr) == CE_None;
    }

    template <class Integer>
    bool convert(const Integer* in, std::size_t n, std::int16_t* out) const {
        constexpr int none = std::numeric_limits<int>::min();
        const bool integral = has_nodata_ && nodata_ == std::floor(nodata_) && std::abs(nodata_) < 1e6;
        const int nodata = integral ? static_cast<int>(nodata_) : none;
        int least = 0, greatest = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const bool valid = static_cast<int>(in[i]) != nodata && (!masked_ || mask_[i] != 0);
            const int v = valid ? static_cast<int>(in[i]) : 0;
            least = std::min(least, v);
            greatest = std::max(greatest, v);
            out[i] = valid ? static_cast<std::int16_t>(v) : void_sample;
        }
        const double metres = std::max(std::abs(least * scale_), std::abs(greatest * scale_));
        return least > water_sample && greatest <= 32767 && metres + std::abs(offset_) <= unbelievable_m;
    }

    template <class Read>
    bool convert(const Read* in, std::size_t n, float* out) const {
        const Read nodata = static_cast<Read>(nodata_);  // a float file's nodata is the float nearest to what it says
        for (std::size_t i = 0; i < n; ++i) {
            const double metres = offset_ + scale_ * static_cast<double>(in[i]);
            const bool valid =
                std::abs(metres) <= unbelievable_m && !(has_nodata_ && in[i] == nodata) && (!masked_ || mask_[i] != 0);
            out[i] = valid ? static_cast<float>(in[i]) : std::numeric_limits<float>::quiet_NaN();
        }
        return true;
    }

    std::string path_;
    RasterOptions options_;
    Dataset dataset_;
    GDALRasterBand& band_;
    int reduction_ = 1;
    double scale_ = 1, offset_ = 0, nodata_ = 0;
    bool has_nodata_ = false, masked_ = false;
    std::vector<char> buffer_;
    std::vector<std::uint8_t> mask_;
};

class GdalDriver : public RasterDriver {
  public:
    GdalDriver() {
        const GdalMessages quiet;
        CPLSetConfigOption("GTIFF_DIRECT_IO", "YES");  // windows of uncompressed strips without decoding whole strips
        GDALAllRegister();
    }

    std::unique_ptr<RasterReader> open(const std::string& path, const RasterOptions& options) const override {
        const GdalMessages messages;
        return std::make_unique<GdalReader>(path, options, messages);
    }

    void limit_cache(std::size_t bytes) const override { GDALSetCacheMax64(static_cast<GIntBig>(bytes)); }

    std::string version() const override { return std::string("GDAL ") + GDALVersionInfo("RELEASE_NAME"); }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::RasterDriver* octaglobe_gdal_3() {
    static const planet::GdalDriver driver;
    return &driver;
}
