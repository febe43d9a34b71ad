#pragma once
// The elevation sources of `octaglobe bake`.

#include <memory>

#include "planet/elevation/elevation_field.h"
#include "planet/geodesy/geoid.h"
#include "render/app/bake_options.h"

namespace render {

/// Opens all sources as one field above EGM96 that answers everywhere.
/// Throws planet::Error: bad_usage where --datum does not fit, a file comes twice or is the output; bad_data for what is
/// missing or not a DEM.
std::shared_ptr<const planet::ElevationField> open_bake_sources(const BakeCommand& command,
                                                                std::shared_ptr<const planet::Geoid> geoid);

}  // namespace render
