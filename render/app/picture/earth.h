#pragma once
// The Earth's heights: the data that ships, and rasters of the user's over it.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/geodesy/geoid.h"
#include "render/app/checksum.h"

namespace render {

/// What the heights are made of.
struct EarthSources {
    std::vector<std::filesystem::path> elevation{};                        ///< over the shipped data, the last on top
    planet::VerticalDatum elevation_datum = planet::VerticalDatum::egm96;  ///< of all of these
    /// What will lie above all this: a shipped raster that is the same as one of these files is left out.
    std::vector<std::filesystem::path> covering{};
};

/// The drawn surface: land as it is, the sea at 0.
struct Earth {
    std::shared_ptr<const planet::ElevationField> heights;  ///< above EGM96; answers everywhere
    std::shared_ptr<const planet::Geoid> geoid;             ///< EGM96
};

/// Opens all sources. Takes some tenths of a second: rasters are decoded and borders between them measured.
/// Throws planet::Error(bad_data) for what is missing or not a DEM.
Earth open_earth(const EarthSources& sources);

/// 64 hexadecimal digits that change if any height may change: of the content of every file, their order and the datum.
/// To name what is made from them. Opens none of them that the index knows.
std::string earth_checksum(const EarthSources& sources, ChecksumIndex& index);

}  // namespace render
