#include "planet/elevation/raster_io.h"

#include <algorithm>
#include <filesystem>

#include "planet/elevation/module.h"
#include "planet/elevation/sha256.h"
#include "planet/elevation/source_file.h"
#include "planet/error.h"

namespace planet {
namespace {

const RasterDriver& driver() {
    using Factory = const RasterDriver* (*)();
    static const RasterDriver* const found =
        reinterpret_cast<Factory>(module_symbol("octaglobe_gdal", "octaglobe_gdal_2", "reading elevation files"))();
    return *found;
}

// Of the bytes of the files; of the samples where there are no files (e.g. inside an archive).
std::string checksum_of(const Raster& raster, std::vector<std::string> files) {
    std::error_code failed;
    std::erase_if(files, [&](const std::string& f) { return !std::filesystem::is_regular_file(f, failed); });
    std::sort(files.begin(), files.end());
    if (files.size() == 1 && raster.reduction == 1) return sha256_of_file(files.front());
    Sha256 sum;
    for (const std::string& file : files) {
        const std::string one = sha256_of_file(file);
        sum.add(one.data(), one.size());
    }
    if (files.empty()) {
        std::visit([&](const auto& s) { sum.add(s.data(), s.size() * sizeof s[0]); }, raster.samples);
        sum.add(&raster.scale, sizeof raster.scale);
        sum.add(&raster.offset, sizeof raster.offset);
        sum.add(&raster.grid, sizeof raster.grid);
        sum.add(raster.crs.data(), raster.crs.size());
    }
    sum.add(&raster.reduction, sizeof raster.reduction);
    return sum.hex();
}

}  // namespace

Raster read_raster(const std::string& path, const RasterOptions& options) {
    check_source_file(path, "an elevation file, e.g. a GeoTIFF");
    std::vector<std::string> files;
    try {
        Raster raster = driver().read(path, options, files);
        raster.name = std::filesystem::path(path).filename().string();
        raster.checksum = checksum_of(raster, std::move(files));
        return raster;
    } catch (const std::bad_alloc&) {
        throw Error(Fault::bad_data, path, "does not fit into memory");
    }
}

std::string raster_library_version() {
    return driver().version();
}

}  // namespace planet
