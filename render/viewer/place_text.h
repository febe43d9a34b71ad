#pragma once
// Places, heights and lengths as the status line writes them.

#include <string>

#include "planet/frames.h"

namespace render {

enum class PlaceFormat { degrees, minutes_seconds, utm, mgrs };
inline constexpr int place_formats = 4;

/// As many digits as a pixel is worth. @param pixel_m metres a pixel, > 0
///
///     37.5767° N  105.4858° W      37° 34′ 36.1″ N  105° 29′ 08.9″ W
///     13N 457 098 E 4 158 942 N    13SDB5709858942
std::string place_text(const planet::Geodetic& place, PlaceFormat format, double pixel_m);

/// "H 4 372.4 m   h 4 351.2 m": above EGM96, and above the ellipsoid.
std::string heights_text(planet::OrthometricHeight H, planet::EllipsoidalHeight h, double pixel_m);

/// "850 m", "12.4 km", "18 500 km": three digits.
std::string length_text(double metres);

struct ScaleBar {
    double metres = 0;  ///< 1, 2 or 5 times a power of ten
    double pixels = 0;  ///< at most what was allowed
    std::string text;
};
ScaleBar scale_bar(double pixel_m, double most_pixels);

/// A place as people type it: "46.85, -121.76", "46.85 -121.76" or an MGRS square. Throws planet::Error (bad_usage).
planet::Geodetic place_from_text(const std::string& text);

}  // namespace render
