#pragma once
// `octaglobe info FILE.octa`: what a store says of itself.

#include <filesystem>

#include "render/app/report.h"

namespace render {

/// Prints it and puts the same into the report. Throws planet::Error(bad_data) for what is no store, or damaged.
void describe_store(const std::filesystem::path& file, Report& report);

}  // namespace render
