#include "planet/elevation/source_file.h"

#include <filesystem>

#include "planet/error.h"

namespace planet {
namespace {

bool is_gdal_name(const std::string& path) {
    return path.starts_with("/vsi") || path.find(':') != std::string::npos;
}

}  // namespace

void check_source_file(const std::string& path, std::string_view accepted) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) {
        if (is_gdal_name(path)) return;
        throw Error(Fault::bad_data, path, "no such file", accepted);
    }
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, failed) == 0)
        throw Error(Fault::bad_data, path, "is empty", accepted);
}

}  // namespace planet
