#include "render/app/store/bake_sources.h"

#include <algorithm>

#include "planet/elevation/elevation_sources.h"
#include "planet/error.h"
#include "render/app/picture/earth.h"
#include "render/app/values.h"

namespace render {
namespace {

namespace fs = std::filesystem;
using planet::Error;
using planet::Fault;

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

std::vector<std::string> files_of(const BakeCommand& command) {
    std::vector<std::string> files;
    for (const std::string& source : command.sources) {
        const auto found = planet::files_of_pattern(source);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

}  // namespace

void check_bake_sources(const BakeCommand& command) {
    const std::size_t given = command.datum.size();
    if (given > 1 && given != command.sources.size())
        throw Error(Fault::bad_usage, "--datum",
                    std::to_string(given) + " for " + std::to_string(command.sources.size()) + " sources",
                    "one for all, or one for each in their order");
    check_files(files_of(command), command.output);
}

std::shared_ptr<const planet::ElevationField> open_bake_sources(const BakeCommand& command,
                                                                const std::shared_ptr<const planet::Geoid>& geoid,
                                                                std::size_t memory_bytes,
                                                                const std::function<void(double)>& progress) {
    std::shared_ptr<const planet::ElevationField> base;
    if (command.over_earth) {
        const std::vector<std::string> files = files_of(command);
        base = open_earth({.covering = {files.begin(), files.end()}}).heights;
    }
    if (command.sources.empty()) return base;
    std::vector<planet::SourceSpec> specs;
    for (const std::string& source : command.sources) {
        specs.push_back({source});
        if (command.datum.size() == 1) specs.back().datum = command.datum.front();
        if (command.datum.size() > 1) specs.back().datum = command.datum[specs.size() - 1];
    }
    planet::SourceOptions options;
    options.geoid = [geoid](auto normals, auto out) { geoid->undulations(normals, out); };
    options.memory_bytes = memory_bytes;
    options.base = base;
    options.progress = progress;
    return planet::open_elevation_sources(specs, options);
}

}  // namespace render
