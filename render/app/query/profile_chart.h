#pragma once
// A terrain profile as a figure: SVG, fit for print.

#include <string>
#include <vector>

namespace render {

struct ProfileChart {
    std::vector<double> distance;  ///< metres, ascending from 0, at least two
    std::vector<double> height;    ///< metres, as many
    std::vector<double> corners;   ///< metres: where legs meet, ends left out
    std::string from, to;          ///< at the ends of the axis
    std::string datum;             ///< of the heights: "EGM96", "the ellipsoid"
    std::string note;              ///< a line below, e.g. the source
    /// Above 0: heights are drawn above the chord between the ends of the level line, which bulges: s (L - s) / 2 R.
    double radius = 0;
};

/// Ticks of an axis: at most `most` + 1 of them, at multiples of 1, 2 or 5 times a power of ten within [low, high].
std::vector<double> ticks(double low, double high, int most);

/// The whole file. Text is escaped. A profile of more samples than the figure can show is drawn by the least and the
/// greatest height in each quarter of a pixel.
std::string svg_of(const ProfileChart& chart);

}  // namespace render
