#include "render/app/picture/earth_store.h"

#include <unistd.h>

#include "planet/error.h"
#include "render/app/data_path.h"

namespace render {

namespace {

using planet::ElevationStore;

planet::BakeOptions options_for(const Earth& earth, const std::function<void(std::string_view, double)>& progress) {
    planet::BakeOptions options;
    set_geoid(options, earth.geoid);
    options.progress = progress;
    options.replace = true;  // what another process of the same number may have left
    return options;
}

/// Bakes into a file of another name first. Nothing if the folder does not take it.
std::shared_ptr<const ElevationStore> bake_to(const std::filesystem::path& file, const Earth& earth,
                                              const planet::BakeOptions& options) {
    std::filesystem::path temporary = file;
    temporary += "." + std::to_string(::getpid()) + ".baking";
    try {
        planet::bake(*earth.heights, options, temporary);
        std::filesystem::rename(temporary, file);
        return std::make_shared<const ElevationStore>(ElevationStore::open(file));
    } catch (const std::exception&) {
        std::error_code ignored;
        for (const char* ending :
             {"", "-journal", "-finishing", "-finishing-journal", "-beginning", "-beginning-journal"})
            std::filesystem::remove(temporary.native() + ending, ignored);
        return nullptr;
    }
}

}  // namespace

void set_geoid(planet::BakeOptions& options, std::shared_ptr<const planet::Geoid> geoid) {
    options.undulation_name = geoid->description();
    options.undulation = [geoid = std::move(geoid)](std::span<const glm::dvec3> normals,
                                                    std::span<planet::GeoidUndulation> out) {
        geoid->undulations(normals, out);
    };
}

std::shared_ptr<const ElevationStore> open_earth_store(const EarthSources& sources, LazyEarth& earth,
                                                       ChecksumIndex& index,
                                                       const std::function<void(std::string_view, double)>& progress) {
    const auto folder = cache_folder();
    std::filesystem::path file;
    if (folder) {
        file = *folder / ("earth-" + earth_checksum(sources, index).substr(0, 32) + "-v" +
                          std::to_string(planet::store_format_version) + ".octa");
        if (std::filesystem::exists(file)) {
            try {
                auto store = std::make_shared<const ElevationStore>(ElevationStore::open(file));
                for (int face = 0; face < planet::face_count; ++face)
                    static_cast<void>(store->read(planet::LocationCode::face_root(face)));
                return store;
            } catch (const planet::Error&) {
                // Damaged: bake it anew.
            }
        }
    }
    const planet::BakeOptions options = options_for(earth.get(), progress);
    if (folder)
        if (auto store = bake_to(file, earth.get(), options)) return store;
    return std::make_shared<const ElevationStore>(planet::bake_in_memory(*earth.get().heights, options));
}

}  // namespace render
