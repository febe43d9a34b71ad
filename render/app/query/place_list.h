#pragma once
// Lists of places: files and standard input.

#include <string>
#include <vector>

#include "planet/frames.h"

namespace render {

inline constexpr std::size_t place_list_max = 50'000'000;

/// Reads places, h = 0. "-" is standard input and, like a file that ends in .csv, .txt or .tsv, a table: one place a
/// line, latitude and longitude in degrees, between commas, semicolons, tabs or blanks. A first line that begins with no
/// number names the columns (lat, latitude, y; lon, lng, long, longitude, x); else they are the first two. Empty lines and
/// lines that begin with # are left out. Any other file is read as features: its points.
/// Throws planet::Error(bad_data) naming file and line if a line holds no place, or the list none or too many.
std::vector<planet::Geodetic> read_places(const std::string& path);

/// The table, already in memory. @param where its name in errors
std::vector<planet::Geodetic> places_from_table(const std::string& where, std::string_view text);

}  // namespace render
