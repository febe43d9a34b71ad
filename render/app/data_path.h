#pragma once
// Where the data that ships with the program lies, and where the user's caches go.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace render {

/// The places where data is looked for, in order: the environment variable OCTAGLOBE_DATA (if set and not empty, the
/// only one), ../share/octaglobe/data from the folder of the executable, data/ of the source tree that was built.
std::vector<std::filesystem::path> data_places();

/// The first of data_places() that is a folder.
std::optional<std::filesystem::path> data_folder();

/// A file of the data folder. Throws planet::Error(bad_data) naming the file and the places if it is not there.
std::filesystem::path data_file(std::string_view name);

/// The user's cache folder, made if need be: $XDG_CACHE_HOME/octaglobe, else $HOME/.cache/octaglobe. Nothing where
/// neither variable holds an absolute path, or the folder cannot be made or written: then keep things in memory.
std::optional<std::filesystem::path> cache_folder();

}  // namespace render
