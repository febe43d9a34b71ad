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

/// Where a coordinate in lattice cells lies: between `cell` and the next, `part` of the way, eased by `weight`.
struct Place {
    std::uint32_t cell;
    float part, weight;

    explicit Place(float v)
        : cell(static_cast<std::uint32_t>(static_cast<std::int32_t>(v))),
          part(v - static_cast<float>(static_cast<std::int32_t>(v))),
          weight(part * part * part * (part * (part * 6 - 15) + 10)) {}
};

/// Perlin noise at a place in the lattice, of which `mask` + 1 cells make a period. No branch and no inner loop: rows
/// of it run on vector units.
inline float perlin(const Place& x, const Place& y, const Place& z, std::uint32_t mask, std::uint32_t octave) {
    const auto corner = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        const float w = (i ? x.weight : 1 - x.weight) * (j ? y.weight : 1 - y.weight) * (k ? z.weight : 1 - z.weight);
        return w * gradient(hash((x.cell + i) & mask, (y.cell + j) & mask, (z.cell + k) & mask, octave),
                            x.part - static_cast<float>(i), y.part - static_cast<float>(j),
                            z.part - static_cast<float>(k));
    };
    return corner(0, 0, 0) + corner(1, 0, 0) + corner(0, 1, 0) + corner(1, 1, 0) + corner(0, 0, 1) + corner(1, 0, 1) +
           corner(0, 1, 1) + corner(1, 1, 1);
}

/// Sum of octaves at every texel of a cube.
std::vector<float> octaves(std::uint32_t side) {
    std::vector<float> field(std::size_t{side} * side * side, 0.0f);
    float amplitude = 0.8f;
    for (std::uint32_t cells = 4; cells < side; cells *= 2, amplitude *= 0.6f) {
        // Off the lattice, where Perlin noise is 0.
        const float step = static_cast<float>(cells) / static_cast<float>(side), shift = 0.37f * step;
        const auto place = [&](std::uint32_t texel) {
            return Place(static_cast<float>(static_cast<std::int32_t>(texel)) * step + shift);
        };
        float* row = field.data();
        for (std::uint32_t z = 0; z < side; ++z)
            for (std::uint32_t y = 0; y < side; ++y, row += side) {
                const Place py = place(y), pz = place(z);
                for (std::uint32_t x = 0; x < side; ++x)
                    row[x] += amplitude * perlin(place(x), py, pz, cells - 1, cells);
            }
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
