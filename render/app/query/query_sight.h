#pragma once
// Options that lines of sight and viewsheds share.

#include <CLI/CLI.hpp>

#include "planet/terrain/sight.h"
#include "render/app/report.h"

namespace render {

/// --eye-height, --target-height, --refraction.
void add_sight_options(CLI::App& command, planet::SightOptions& options);
void report_sight_options(const planet::SightOptions& options, Report& report);

}  // namespace render
