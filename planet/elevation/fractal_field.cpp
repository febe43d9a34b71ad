#include "planet/elevation/fractal_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "planet/elevation/constant_field.h"
#include "planet/elevation/sha256.h"
#include "planet/error.h"

namespace planet {
namespace {

// 1 / root mean square of the plain noise, by averaging 8 million random positions (within 0.1 %).
constexpr double noise_scale = 3.703;
// The mean of |noise| at that scale, so that folded octaves have mean 0.
constexpr double mean_absolute = 0.8155;

std::uint32_t mix(std::uint32_t h) {  // the finalizer of MurmurHash3 (Appleby)
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    return h ^ (h >> 16);
}

std::uint32_t hash(std::uint32_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return mix(x * 0x9e3779b1u + mix(y * 0x85ebca77u + mix(z * 0xc2b2ae3du + seed)));
}

// Product of one of the twelve gradients (the middles of a cube's sides; four twice) with (x, y, z).
double slope(std::uint32_t h, double x, double y, double z) {
    const std::uint32_t k = h >> 28;
    const double u = k < 8 ? x : y;
    const double v = k < 4 ? y : (k == 12 || k == 14) ? x : z;
    return ((k & 1) != 0 ? -u : u) + ((k & 2) != 0 ? -v : v);
}

double mix_linearly(double a, double b, double t) {
    return a + t * (b - a);
}

double blend(double t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

double noise(const glm::dvec3& p, std::uint32_t seed) {
    const glm::dvec3 cell = glm::floor(p), f = p - cell;
    const auto bits = [](double v) { return static_cast<std::uint32_t>(static_cast<std::int64_t>(v)); };
    const std::uint32_t x = bits(cell.x), y = bits(cell.y), z = bits(cell.z);
    double corner[8];
    for (std::uint32_t k = 0; k < 8; ++k) {
        const std::uint32_t i = k & 1, j = k >> 1 & 1, l = k >> 2;
        corner[k] = slope(hash(seed, x + i, y + j, z + l), f.x - i, f.y - j, f.z - l);
    }
    const double u = blend(f.x), v = blend(f.y), w = blend(f.z);
    const double low = mix_linearly(mix_linearly(corner[0], corner[1], u), mix_linearly(corner[2], corner[3], u), v);
    const double high = mix_linearly(mix_linearly(corner[4], corner[5], u), mix_linearly(corner[6], corner[7], u), v);
    return noise_scale * mix_linearly(low, high, w);
}

// 2^x, 0 <= x <= 2, from square roots, which are the same on every machine.
double power_of_two(double x) {
    double power = 1, root = 4;
    for (double bit = 2; bit > 1e-9; bit *= 0.5, root = std::sqrt(root))
        if (x >= bit) {
            x -= bit;
            power *= root;
        }
    return power;
}

void check(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    char text[64], accepted[80];
    std::snprintf(text, sizeof text, "%g is out of range", value);
    std::snprintf(accepted, sizeof accepted, "%g to %g", low, high);
    throw Error(Fault::bad_usage, std::string("fractal ") + name, text, accepted);
}

std::string describe(const FractalParameters& p) {
    char text[256];
    std::snprintf(text, sizeof text,
                  "fractal seed=%u amplitude=%.17g longest=%.17g shortest=%.17g hurst=%.17g radius=%.17g%s", p.seed,
                  p.amplitude_m, p.longest_m, p.shortest_m, p.hurst, p.radius_m, p.ridged ? " ridged" : "");
    return text;
}

std::string sha256_of_text(const std::string& text) {
    Sha256 sum;
    sum.add(text.data(), text.size());
    return sum.hex();
}

}  // namespace

FractalField::FractalField(const FractalParameters& p) : parameters_(p) {
    check("radius", p.radius_m, 1, 1e9);
    check("amplitude", p.amplitude_m, 0, 1e6);
    check("longest wavelength", p.longest_m, p.radius_m * 1e-9, p.radius_m * 1e3);
    check("shortest wavelength", p.shortest_m, p.radius_m * 1e-9, p.longest_m);
    check("roughness", p.hurst, 0, 2);
    const double gain = 1 / power_of_two(p.hurst);
    double amplitude = p.amplitude_m, length = p.longest_m;
    for (std::uint32_t k = 0; length >= p.shortest_m; ++k, length *= 0.5, amplitude *= gain) {
        const std::uint32_t seed = mix(p.seed * 0x9e3779b1u + k);
        const auto shift = [&](std::uint32_t axis) { return mix(seed + axis) * 0x1p-24; };
        octaves_.push_back({p.radius_m / length, amplitude, {shift(1), shift(2), shift(3)}, seed});
    }
}

void FractalField::heights(std::span<const glm::dvec3> normals, std::span<float> out) const {
    assert(out.size() == normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const glm::dvec3& n = normals[i];
        double h = 0 * (n.x + n.y + n.z);
        if (!std::isnan(h))
            for (const Octave& o : octaves_) {
                const double v = noise(n * o.frequency + o.shift, o.seed);
                h += o.amplitude * (parameters_.ridged ? std::sqrt(3.0) * (mean_absolute - std::abs(v)) : v);
            }
        out[i] = static_cast<float>(h);
    }
}

double FractalField::spacing(const Cap&) const {
    return 0.25 * parameters_.radius_m / octaves_.back().frequency;
}

std::vector<SourceInfo> FractalField::sources() const {
    const std::string text = describe(parameters_);
    return {{text, sha256_of_text(text), "", parameters_.datum, 0}};
}

std::vector<SourceInfo> ConstantField::sources() const {
    char text[64];
    std::snprintf(text, sizeof text, "constant %.9g m", static_cast<double>(height_m_));
    return {{text, sha256_of_text(text), "", datum_, 0}};
}

}  // namespace planet
