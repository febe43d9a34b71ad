#pragma once
// How much two pictures differ, and where.

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "planet/elevation/image.h"

namespace render {

struct PictureDifference {
    std::size_t pixels = 0;  ///< of each picture; 0: the sizes differ
    std::size_t beyond = 0;  ///< with a channel that differs by more than the tolerance
    int worst = 0;           ///< of a channel, 0..255
    planet::Image image{};   ///< differences, eight times as bright

    /// Share of the pixels beyond the tolerance; 1 where the sizes differ.
    double share() const { return pixels == 0 ? 1 : static_cast<double>(beyond) / static_cast<double>(pixels); }
};

/// @param tolerance of a channel, 0..255. Alpha is not looked at.
inline PictureDifference compare(const planet::Image& a, const planet::Image& b, int tolerance) {
    PictureDifference d;
    if (a.width != b.width || a.height != b.height) return d;
    d.pixels = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
    d.image = {a.width, a.height, 3, {}};
    d.image.pixels.reserve(d.pixels * 3);
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            int worst = 0;
            for (int channel = 0; channel < 3; ++channel) {
                const int off = std::abs(a.pixel(x, y)[channel] - b.pixel(x, y)[channel]);
                worst = std::max(worst, off);
                d.image.pixels.push_back(static_cast<std::uint8_t>(std::min(255, 8 * off)));
            }
            d.worst = std::max(d.worst, worst);
            d.beyond += worst > tolerance;
        }
    return d;
}

}  // namespace render
