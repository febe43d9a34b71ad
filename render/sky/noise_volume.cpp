// Noise that repeats, with its gradient: value noise on the texels' own lattice, summed over octaves.

#include <cassert>
#include <cmath>

#include "render/sky/atmosphere.h"

namespace render {
namespace {

/// A lattice value in [-1, 1) from an integer hash (the finalizer of MurmurHash3).
float lattice(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t octave) {
    std::uint32_t k = x * 0x8da6b343u + y * 0xd8163841u + z * 0xcb1ab31fu + octave * 0x9e3779b9u;
    k = (k ^ (k >> 16)) * 0x85ebca6bu;
    k = (k ^ (k >> 13)) * 0xc2b2ae35u;
    k ^= k >> 16;
    return static_cast<float>(k >> 8) * 0x1p-23f - 1.0f;
}

/// Sum of octaves at every texel of a cube.
std::vector<float> octaves(std::uint32_t side) {
    std::vector<float> field(std::size_t{side} * side * side, 0.0f);
    float amplitude = 0.5f;
    for (std::uint32_t cells = 4; cells <= side; cells *= 2, amplitude *= 0.62f) {
        const std::uint32_t cell = side / cells, mask = cells - 1;
        std::size_t at = 0;
        for (std::uint32_t z = 0; z < side; ++z)
            for (std::uint32_t y = 0; y < side; ++y)
                for (std::uint32_t x = 0; x < side; ++x, ++at) {
                    const auto smooth = [&](std::uint32_t v) {
                        const float t = static_cast<float>(v % cell) / static_cast<float>(cell);
                        return t * t * (3 - 2 * t);
                    };
                    const float wx = smooth(x), wy = smooth(y), wz = smooth(z);
                    float sum = 0;
                    for (std::uint32_t k = 0; k < 8; ++k) {
                        const std::uint32_t i = k & 1, j = k >> 1 & 1, l = k >> 2;
                        const float w = (i ? wx : 1 - wx) * (j ? wy : 1 - wy) * (l ? wz : 1 - wz);
                        if (w > 0)
                            sum += w * lattice((x / cell + i) & mask, (y / cell + j) & mask, (z / cell + l) & mask, cells);
                    }
                    field[at] += amplitude * sum;
                }
    }
    return field;
}

std::uint8_t byte_of(float v) {
    return static_cast<std::uint8_t>(std::lround(std::fmin(std::fmax(127.5f + 127.5f * v, 0.0f), 255.0f)));
}

}  // namespace

std::vector<std::uint8_t> make_noise_volume(int side) {
    assert(side >= 16 && side <= 128 && (side & (side - 1)) == 0);
    const auto n = static_cast<std::uint32_t>(side), mask = n - 1;
    const std::vector<float> field = octaves(n);
    const auto value = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
        return field[(std::size_t{z & mask} * n + (y & mask)) * n + (x & mask)];
    };
    std::vector<std::uint8_t> bytes;
    bytes.reserve(field.size() * 4);
    for (std::uint32_t z = 0; z < n; ++z)
        for (std::uint32_t y = 0; y < n; ++y)
            for (std::uint32_t x = 0; x < n; ++x) {
                bytes.push_back(byte_of(0.8f * (value(x + 1, y, z) - value(x - 1, y, z))));
                bytes.push_back(byte_of(0.8f * (value(x, y + 1, z) - value(x, y - 1, z))));
                bytes.push_back(byte_of(0.8f * (value(x, y, z + 1) - value(x, y, z - 1))));
                bytes.push_back(byte_of(0.9f * value(x, y, z)));
            }
    return bytes;
}

}  // namespace render
