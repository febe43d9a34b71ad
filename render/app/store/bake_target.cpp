#include "render/app/store/bake_target.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "planet/error.h"
#include "planet/store/elevation_store.h"
#include "planet/store/store_tables.h"
#include "render/app/values.h"

namespace render {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& output, std::string_view what, std::string_view accepted) {
    throw planet::Error(planet::Fault::bad_usage, "--output", shown(output.native()) + " " + std::string(what),
                        accepted);
}

/// Without a file to try it with: a bake that is killed leaves nothing but its store.
void check_folder(const fs::path& output) {
    const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        refuse(output, "cannot be written: " + std::generic_category().message(errno),
               "a file in a folder that exists and can be written");
}

/// Whether the file begins as an SQLite file with the application id of stores, whatever its version and state.
bool is_store(const fs::path& file) {
    std::array<char, 72> header{};
    std::ifstream in(file, std::ios::binary);
    in.read(header.data(), header.size());
    if (in.gcount() < static_cast<std::streamsize>(header.size())) return false;
    std::uint32_t id = 0;
    for (std::size_t i = 68; i < header.size(); ++i) id = id << 8 | static_cast<unsigned char>(header[i]);
    return std::memcmp(header.data(), "SQLite format 3", 16) == 0 && id == planet::store_application_id;
}

}  // namespace

BakeTarget check_bake_target(const fs::path& output, bool resume, bool replace) {
    std::error_code ignored;
    const fs::file_status status = fs::status(output, ignored);
    if (!fs::exists(status)) {
        check_folder(output);
        return BakeTarget::absent;
    }
    if (!fs::is_regular_file(status))
        refuse(output, "is not a file", "a new file, or a store to --resume or --replace");
    // A bake that is killed before it has written anything leaves an empty file.
    const bool empty = fs::file_size(output) == 0;
    if (!empty && !is_store(output)) refuse(output, "is there, and no elevation store", "another name");
    if (empty && (resume || replace)) return BakeTarget::absent;
    if (replace) {
        check_folder(output);
        return BakeTarget::replaced;
    }
    if (empty) refuse(output, "is there already, and empty", "--replace, or another name");
    const bool finished = planet::ElevationStore::open(output).metadata().complete;
    if (resume) return finished ? BakeTarget::finished : BakeTarget::unfinished;
    if (finished) refuse(output, "is a finished store", "--replace to bake it anew, or another name");
    refuse(output, "is a store that is not finished", "--resume to go on, --replace to begin anew, or another name");
}

}  // namespace render
