#pragma once
// Values as people write them on a command line, with units and ranges. Each parser takes the name of the option for
// its error and the text; it reads the whole text or throws planet::Error(bad_usage) with one line that says what would
// be accepted. NaN, infinities, empty text and anything left over are refused. Blanks around a value are ignored.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "planet/frames.h"

namespace render {

/// A closed interval in the unit that the user writes.
struct Range {
    double low = 0, high = 0;
};

/// A finite decimal number within the range. `unit` is only told in the error, e.g. "degrees".
double parse_number(std::string_view where, std::string_view text, Range range, std::string_view unit = {});

/// A whole number within the range.
long parse_whole(std::string_view where, std::string_view text, long low, long high);

/// A length with an optional unit (m, km, ft, mi, nmi; none: metres), in metres: "60km", "12 nmi", "2e7".
/// @param range metres
double parse_distance(std::string_view where, std::string_view text, Range range);

/// An amount of memory with an optional unit (B, KB, MB, GB, TB of 1000; KiB, MiB, GiB, TiB or K, M, G, T of 1024;
/// none: bytes): "512MiB", "1.5 G".
std::size_t parse_memory(std::string_view where, std::string_view text, std::size_t low, std::size_t high);

/// "LAT,LON" in degrees to radians, h = 0. Latitude -90..90; longitude -180..360, wrapped to [-pi, pi].
planet::Geodetic parse_place(std::string_view where, std::string_view text);

/// Degrees within the range, in radians.
double parse_angle(std::string_view where, std::string_view text, Range range);

/// The size of a picture in pixels.
struct PictureSize {
    std::int32_t width = 0, height = 0;
    friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

inline constexpr int picture_side_max = 65535;  ///< pixels

/// "1920x1080", each side 1..picture_side_max.
PictureSize parse_size(std::string_view where, std::string_view text);

/// A rectangle of a picture, pixels from its top left.
struct PictureCrop {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
};

/// "1000,200,640x480": X,Y,WIDTHxHEIGHT.
PictureCrop parse_crop(std::string_view where, std::string_view text);

/// One of the names; returns its index.
std::size_t parse_choice(std::string_view where, std::string_view text, const std::vector<std::string_view>& names);

/// Names separated by commas, each at most once; returns their indices in the order given.
std::vector<std::size_t> parse_choices(std::string_view where, std::string_view text,
                                       const std::vector<std::string_view>& names);

/// "50,150,250": whole numbers within the range, separated by commas.
std::vector<std::size_t> parse_wholes(std::string_view where, std::string_view text, long low, long high);

/// The path of a picture that can be written, by its ending.
std::filesystem::path parse_picture_name(std::string_view where, std::string_view text);

/// What the user wrote, fit for an error line: quoted, control characters and bytes beyond ASCII as '?', and cut after
/// 60 characters.
std::string shown(std::string_view text);

}  // namespace render
