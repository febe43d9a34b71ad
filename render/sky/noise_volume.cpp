// Noise that repeats, with its gradient: Perlin noise, summed over octaves.

#include <cassert>
#include <cmath>

#include "render/sky/atmosphere.h"

namespace render {
namespace {

/// An integer hash (the finalizer of MurmurHash3).
std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t octave) {
    std::uint32_t k = x * 0x8da6b343u + y * 0xd8163841u + z * 0xcb1ab31fu + octave * 0x9e3779b9u;
    k = (k ^ (k >> 16)) * 0x85ebca6bu;
    k = (k ^ (k >> 13)) * 0xc2b2ae35u;
    return k ^ (k >> 16);
}

/// Dot product with one of the twelve gradients of K. Perlin, "Improving Noise", 2002.
float gradient(std::uint32_t h, float x, float y, float z) {
    h &= 15;
    const float u = h < 8 ? x : y, v = h < 4 ? y : (h == 12 || h == 14 ? x : z);
    return ((h & 1) != 0 ? -u : u) + ((h & 2) != 0 ? -v : v);
}

/// Perlin noise at (x, y, z) in cells, of which `mask` + 1 make a period.
float perlin(float x, float y, float z, std::uint32_t mask, std::uint32_t octave) {
    const auto ix = static_cast<std::uint32_t>(x), iy = static_cast<std::uint32_t>(y),
               iz = static_cast<std::uint32_t>(z);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy), fz = z - static_cast<float>(iz);
    const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const float wx = fade(fx), wy = fade(fy), wz = fade(fz);
    float sum = 0;
    for (std::uint32_t k = 0; k < 8; ++k) {
        const std::uint32_t i = k & 1, j = k >> 1 & 1, l = k >> 2;
        const float w = (i ? wx : 1 - wx) * (j ? wy : 1 - wy) * (l ? wz : 1 - wz);
        sum += w * gradient(hash((ix + i) & mask, (iy + j) & mask, (iz + l) & mask, octave), fx - static_cast<float>(i),
                            fy - static_cast<float>(j), fz - static_cast<float>(l));
    }
    return sum;
}

/// Sum of octaves at every texel of a cube.
std::vector<float> octaves(std::uint32_t side) {
    std::vector<float> field;
    field.reserve(std::size_t{side} * side * side);
    for (std::uint32_t z = 0; z < side; ++z)
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                float sum = 0, amplitude = 0.8f;
                for (std::uint32_t cells = 4; cells < side; cells *= 2, amplitude *= 0.6f) {
                    // Off the lattice, where Perlin noise is 0.
                    const float step = static_cast<float>(cells) / static_cast<float>(side), shift = 0.37f * step;
                    sum +=
                        amplitude * perlin(static_cast<float>(x) * step + shift, static_cast<float>(y) * step + shift,
                                           static_cast<float>(z) * step + shift, cells - 1, cells);
                }
                field.push_back(sum);
            }
    return field;
}

std::uint8_t byte_of(float v) {
    return static_cast<std::uint8_t>(std::lround(std::fmin(std::fmax(127.5f + 127.5f * v, 0.0f), 255.0f)));
}

/// The next coarser level, m texels a side.
std::vector<std::uint8_t> half(const std::vector<std::uint8_t>& fine, std::uint32_t m) {
    std::vector<std::uint8_t> out;
    out.reserve(std::size_t{m} * m * m * 4);
    for (std::uint32_t z = 0; z < m; ++z)
        for (std::uint32_t y = 0; y < m; ++y)
            for (std::uint32_t x = 0; x < m; ++x)
                for (std::size_t c = 0; c < 4; ++c) {
                    unsigned sum = 4;
                    for (std::uint32_t k = 0; k < 8; ++k) {
                        const std::size_t at =
                            (std::size_t{2 * z + (k >> 2)} * (2 * m) + (2 * y + (k >> 1 & 1))) * (2 * m) +
                            (2 * x + (k & 1));
                        sum += fine[at * 4 + c];
                    }
                    out.push_back(static_cast<std::uint8_t>(sum / 8));
                }
    return out;
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

std::vector<std::vector<std::uint8_t>> make_noise_levels(int side) {
    std::vector<std::vector<std::uint8_t>> levels{make_noise_volume(side)};
    for (auto m = static_cast<std::uint32_t>(side) / 2; m > 0; m /= 2) levels.push_back(half(levels.back(), m));
    return levels;
}

}  // namespace render
