#pragma once
// Where heights came from, for reports.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planet/elevation/elevation_field.h"

namespace render {

/// A list of objects: name, sha256, crs, vertical_datum, spacing_m.
nlohmann::ordered_json sources_json(const std::vector<planet::SourceInfo>& sources);

/// A CRS for a line of text: as it is if it is short, else the name that its WKT begins with.
std::string crs_text(const std::string& crs);

}  // namespace render
