#include "render/app/bake_sources.h"

#include <glob.h>

#include <algorithm>

#include "planet/elevation/layered_field.h"
#include "planet/elevation/raster_field.h"
#include "planet/error.h"
#include "render/app/earth.h"
#include "render/app/values.h"

namespace render {
namespace {

namespace fs = std::filesystem;
using planet::Error;
using planet::Fault;

std::vector<std::string> files_of(const std::string& pattern) {
    std::error_code ignored;
    if (fs::exists(pattern, ignored) || pattern.find_first_of("*?[") == std::string::npos) return {pattern};
    glob_t found{};
    const int result = ::glob(pattern.c_str(), 0, nullptr, &found);
    std::vector<std::string> files;
    for (std::size_t i = 0; result == 0 && i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
    ::globfree(&found);
    if (files.empty()) throw Error(Fault::bad_data, pattern, "no file matches", "a file, or a pattern of some");
    return files;
}

/// One file is one source, and never the output.
void check_files(const std::vector<std::string>& files, const fs::path& output) {
    std::error_code ignored;
    std::vector<fs::path> known;
    for (const auto& file : files) {
        if (fs::exists(output, ignored) && fs::equivalent(file, output, ignored))
            throw Error(Fault::bad_usage, "--output", shown(output.native()) + " is one of the sources",
                        "another name");
        known.push_back(fs::weakly_canonical(file, ignored));
    }
    for (std::size_t i = 0; i < files.size(); ++i)
        if (std::find(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(i), known[i]) !=
            known.begin() + static_cast<std::ptrdiff_t>(i))
            throw Error(Fault::bad_usage, files[i], "is a source twice", "each file once");
}

}  // namespace

std::shared_ptr<const planet::ElevationField> open_bake_sources(const BakeCommand& command,
                                                                std::shared_ptr<const planet::Geoid> geoid) {
    const std::size_t given = command.datum.size();
    if (given > 1 && given != command.sources.size())
        throw Error(Fault::bad_usage, "--datum",
                    std::to_string(given) + " for " + std::to_string(command.sources.size()) + " sources",
                    "one for all, or one for each in their order");
    std::vector<std::shared_ptr<const planet::ElevationField>> layers;
    std::vector<std::string> all;
    std::vector<planet::VerticalDatum> datum;
    for (std::size_t i = 0; i < command.sources.size(); ++i)
        for (const std::string& file : files_of(command.sources[i])) {
            all.push_back(file);
            datum.push_back(given == 0   ? planet::VerticalDatum::egm96
                            : given == 1 ? command.datum.front()
                                         : command.datum[i]);
        }
    check_files(all, command.output);
    if (command.over_earth) layers.push_back(open_earth({}).heights);
    for (std::size_t i = 0; i < all.size(); ++i) layers.push_back(planet::open_raster_field(all[i], datum[i]));
    return std::make_shared<planet::LayeredField>(std::move(layers), planet::VerticalDatum::egm96,
                                                  [geoid](const glm::dvec3& n) { return geoid->undulation(n); });
}

}  // namespace render
