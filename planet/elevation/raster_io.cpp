#include "planet/elevation/raster_io.h"

#include <algorithm>
#include <filesystem>

#include "planet/elevation/module.h"
#include "planet/elevation/sha256.h"
#include "planet/elevation/source_file.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr const char* elevation_file = "an elevation file, e.g. a GeoTIFF";

// In pieces of about a million samples. False if one does not fit.
template <class Sample>
bool read_all(RasterReader& reader, Raster& raster) {
    std::vector<Sample> samples(raster.count());
    const int rows_at_once = std::max(1, (1 << 20) / raster.width);
    for (int row = 0; row < raster.height; row += rows_at_once) {
        const SampleWindow window{0, row, raster.width, std::min(rows_at_once, raster.height - row)};
        const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(raster.width);
        const auto out = std::span(samples).subspan(first, window.count());
        if constexpr (std::is_same_v<Sample, std::int16_t>) {
            if (!reader.read(window, out)) return false;
        } else {
            reader.read(window, out);
        }
    }
    raster.samples = std::move(samples);
    return true;
}

}  // namespace

const RasterDriver& raster_driver() {
    using Factory = const RasterDriver* (*)();
    static const RasterDriver* const found =
        reinterpret_cast<Factory>(module_symbol("octaglobe_gdal", "octaglobe_gdal_3", "reading elevation files"))();
    return *found;
}

std::string checksum_of_files(std::vector<std::string> files) {
    std::error_code failed;
    std::erase_if(files, [&](const std::string& f) { return !std::filesystem::is_regular_file(f, failed); });
    // However they are written: the order must not depend on the folder from which they are named.
    for (std::string& file : files) file = std::filesystem::weakly_canonical(file, failed).string();
    std::sort(files.begin(), files.end());
    files.erase(std::unique(files.begin(), files.end()), files.end());
    if (files.empty()) return {};
    if (files.size() == 1) return sha256_of_file(files.front());
    Sha256 sum;
    for (const std::string& file : files) {
        const std::string one = sha256_of_file(file);
        sum.add(one.data(), one.size());
    }
    return sum.hex();
}

void add_to_checksum(const RasterHeader& raster, Sha256& sum) {
    sum.add(&raster.scale, sizeof raster.scale);
    sum.add(&raster.offset, sizeof raster.offset);
    sum.add(&raster.grid, sizeof raster.grid);
    sum.add(raster.crs.data(), raster.crs.size());
    sum.add(&raster.reduction, sizeof raster.reduction);
}

std::string checksum_of(const Raster& raster, std::vector<std::string> files) {
    std::string of_files = checksum_of_files(std::move(files));
    if (!of_files.empty() && raster.reduction == 1) return of_files;
    Sha256 sum;
    if (of_files.empty()) {
        std::visit([&](const auto& s) { sum.add(s.data(), s.size() * sizeof s[0]); }, raster.samples);
        add_to_checksum(raster, sum);
        return sum.hex();
    }
    sum.add(of_files.data(), of_files.size());
    sum.add(&raster.reduction, sizeof raster.reduction);
    return sum.hex();
}

bool holds_a_height(const Raster& raster) {
    if (const auto* shorts = std::get_if<std::vector<std::int16_t>>(&raster.samples))
        return std::any_of(shorts->begin(), shorts->end(), [](std::int16_t s) { return s != void_sample; });
    const auto& floats = std::get<std::vector<float>>(raster.samples);
    return std::any_of(floats.begin(), floats.end(), [](float f) { return !std::isnan(f); });
}

std::unique_ptr<RasterReader> open_raster(const std::string& path, const RasterOptions& options) {
    check_source_file(path, elevation_file);
    return raster_driver().open(path, options);
}

Raster read_raster(const std::string& path, const RasterOptions& options) {
    try {
        const auto reader = open_raster(path, options);
        Raster raster;
        static_cast<RasterHeader&>(raster) = reader->header();
        if (static_cast<std::int64_t>(raster.count()) > options.max_samples)
            throw Error(Fault::bad_data, path,
                        std::to_string(raster.width) + "x" + std::to_string(raster.height) + " samples are too many",
                        "at most " + std::to_string(options.max_samples) + " samples; cut or reduce it");
        if (!reader->may_be_shorts() || !read_all<std::int16_t>(*reader, raster)) read_all<float>(*reader, raster);
        if (!holds_a_height(raster))
            throw Error(Fault::bad_data, path, "holds no heights: every sample is nodata", "one band of heights");
        raster.name = std::filesystem::path(path).filename().string();
        raster.checksum = checksum_of(raster, reader->files());
        return raster;
    } catch (const std::bad_alloc&) {
        throw Error(Fault::bad_data, path, "does not fit into memory");
    }
}

std::string raster_library_version() {
    return raster_driver().version();
}

}  // namespace planet
