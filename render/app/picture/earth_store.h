#pragma once
// The baked Earth: opened from the user's cache folder, baked there on first need.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "planet/bake/bake.h"
#include "render/app/picture/earth.h"

namespace render {

/// The heights of a picture or a query: opened at most once, only if something has to be made from them.
class LazyEarth {
  public:
    explicit LazyEarth(const EarthSources& sources) : sources_(sources) {}
    const Earth& get() {
        if (!earth_) earth_ = open_earth(sources_);
        return *earth_;
    }

  private:
    const EarthSources& sources_;
    std::optional<Earth> earth_;
};

/// Heights above a geoid are baked with its undulations.
void set_geoid(planet::BakeOptions& options, std::shared_ptr<const planet::Geoid> geoid);

/// The store of these sources, under a name made of their checksums and the format's version. It is baked beside its
/// place and renamed, so a store that is there is whole; where there is no cache folder, or it is full, it is kept in memory.
/// Throws planet::Error(bad_data) for sources that cannot be read.
std::shared_ptr<const planet::ElevationStore> open_earth_store(
    const EarthSources& sources, LazyEarth& earth, ChecksumIndex& index,
    const std::function<void(std::string_view, double)>& progress);

}  // namespace render
