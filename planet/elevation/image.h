#pragma once
// Pictures in memory.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace planet {

/// Row-major from the top left, channels interleaved: RGB, or RGBA with straight (not premultiplied) alpha.
template <class Sample>
struct BasicImage {
    int width = 0, height = 0;
    int channels = 3;  ///< 3 or 4
    std::vector<Sample> pixels;

    std::size_t row_size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels); }
    const Sample* pixel(int x, int y) const {
        return pixels.data() + static_cast<std::size_t>(y) * row_size() + static_cast<std::size_t>(x * channels);
    }
};

using Image = BasicImage<std::uint8_t>;       ///< 8-bit sRGB
using DeepImage = BasicImage<std::uint16_t>;  ///< 16-bit sRGB
using FloatImage = BasicImage<float>;         ///< linear light; alpha in [0, 1]

}  // namespace planet
