#pragma once
// What can be said of a file's name before a library opens it.

#include <string>
#include <string_view>

namespace planet {

/// Throws Error(bad_data) if there is no such file or it is empty. Folders pass (some formats are folders), and so do names that GDAL knows and
/// the file system does not ("NETCDF:relief.nc:height", "/vsizip/...").
/// @param accepted for the message, e.g. "an elevation file, e.g. a GeoTIFF"
void check_source_file(const std::string& path, std::string_view accepted);

}  // namespace planet
