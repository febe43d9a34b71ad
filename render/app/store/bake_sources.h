#pragma once
// The elevation sources of `octaglobe bake`.

#include <functional>
#include <memory>

#include "planet/elevation/elevation_field.h"
#include "planet/geodesy/geoid.h"
#include "render/app/store/bake_options.h"

namespace render {

/// What is wrong with the sources that shows in their names. Throws planet::Error: bad_usage where --datum does not fit,
/// a file comes twice or is the output; bad_data where a pattern matches nothing.
void check_bake_sources(const BakeCommand& command);

/// Opens all sources as one field above EGM96 that answers everywhere. @param memory_bytes of their samples
/// Throws planet::Error(bad_data) for what is missing or not a DEM.
std::shared_ptr<const planet::ElevationField> open_bake_sources(const BakeCommand& command,
                                                                const std::shared_ptr<const planet::Geoid>& geoid,
                                                                std::size_t memory_bytes,
                                                                const std::function<void(double)>& progress);

}  // namespace render
