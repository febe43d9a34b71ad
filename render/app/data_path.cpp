#include "render/app/data_path.h"

#include <unistd.h>

#include <cstdlib>
#include <string>

#include "planet/error.h"
#include "render/app/values.h"
#include "render/app/version.h"

namespace render {
namespace fs = std::filesystem;

std::vector<fs::path> data_places() {
    if (const char* named = std::getenv("OCTAGLOBE_DATA"); named && *named) return {fs::path(named)};
    std::vector<fs::path> places;
    std::error_code failure;
    if (const fs::path executable = fs::read_symlink("/proc/self/exe", failure); !failure)
        places.push_back(executable.parent_path().parent_path() / "share/octaglobe/data");
    places.emplace_back(source_data_folder);
    return places;
}

std::optional<fs::path> data_folder() {
    std::error_code ignored;
    for (auto& place : data_places())
        if (fs::is_directory(place, ignored)) return place;
    return {};
}

fs::path data_file(std::string_view name) {
    std::error_code ignored;
    const auto folder = data_folder();
    if (folder && fs::is_regular_file(*folder / name, ignored)) return *folder / name;
    std::string places;
    for (const auto& place : data_places()) places.append(places.empty() ? "" : ", ").append(place.native());
    throw planet::Error(planet::Fault::bad_data, std::string(name), "this file of the program's data is missing",
                        "OCTAGLOBE_DATA set to the data folder; looked in " + places);
}

std::optional<fs::path> cache_folder() {
    fs::path base;
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg == '/')
        base = xdg;
    else if (const char* home = std::getenv("HOME"); home && *home == '/')
        base = fs::path(home) / ".cache";
    else
        return {};
    std::error_code failure;
    fs::path folder = base / "octaglobe";
    fs::create_directories(folder, failure);
    if (failure || ::access(folder.c_str(), W_OK | X_OK) != 0) return {};
    return folder;
}

}  // namespace render
