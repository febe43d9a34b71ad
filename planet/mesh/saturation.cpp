#include "planet/mesh/saturation.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace planet {

namespace {

// By local index: the cell across the split side, or the cell itself on the tile's border.
std::array<std::uint16_t, tile_cells> make_partners() {
    std::array<std::uint16_t, tile_cells> partner{};
    for (unsigned i = 1; i < tile_cells; ++i) {
        const std::uint16_t beyond = tile_layout().split_neighbor[i];
        partner[i] = beyond != 0 ? beyond : static_cast<std::uint16_t>(i);
    }
    return partner;
}

inline float larger(float a, float b) {
    return a > b ? a : b;
}

}  // namespace

void TileSaturation::start(int depth, std::span<const glm::vec3> rounded) {
    assert(depth >= 1 && depth <= tile_levels);
    depth_ = depth;
    const std::size_t cells = std::size_t{1} << depth;
    for (std::vector<float>* v : {&x_, &y_, &z_}) v->resize(cells);
    deviation_.resize(cells / 2);
    radius_.resize(cells / 2);
    const auto& split_vertex = tile_layout().split_vertex;
    for (std::size_t i = 1; i < cells; ++i) {
        const glm::vec3& m = rounded[split_vertex[i]];
        x_[i] = m.x;
        y_[i] = m.y;
        z_[i] = m.z;
    }
}

// Over the diamonds of the two children. One that does not exist has a record of zeros, and does not count.
void TileSaturation::raise(unsigned first, std::span<const std::uint8_t> exists, const float* deviation,
                           const float* radius) {
    const float *x = x_.data(), *y = y_.data(), *z = z_.data();
    float *out_deviation = deviation_.data(), *out_radius = radius_.data();
    const std::uint8_t* there = exists.data();
    const auto reach = [&](std::size_t i, std::size_t child) {
        const double r = radius_over({x[i], y[i], z[i]}, {x[child], y[child], z[child]}, radius[child]);
        return deviation[child] > 0 ? r : 0.0;
    };
#pragma GCC ivdep
    for (std::size_t k = 0; k < first; ++k) {
        const std::size_t i = first + k;
        const double r0 = reach(i, 2 * i), r1 = reach(i, 2 * i + 1);
        const float r = certified_radius(r0 > r1 ? r0 : r1);
        const float d = larger(deviation[2 * i], deviation[2 * i + 1]);
        out_deviation[k] = there[i] ? larger(deviation[i], d) : 0.0f;
        out_radius[k] = there[i] ? larger(radius[i], r) : 0.0f;
    }
}

void TileSaturation::level(int level, std::span<const std::uint8_t> exists, std::span<float> deviation,
                           std::span<float> radius) {
    static const auto partner = make_partners();
    const unsigned first = 1u << level;
    if (level < depth_ - 1) {
        raise(first, exists, deviation.data(), radius.data());
    } else {
        for (unsigned k = 0; k < first; ++k) {
            deviation_[k] = exists[first + k] ? deviation[first + k] : 0.0f;
            radius_[k] = exists[first + k] ? radius[first + k] : 0.0f;
        }
    }
    const float *d = deviation_.data(), *r = radius_.data();
    float *out_deviation = deviation.data() + first, *out_radius = radius.data() + first;
    const std::uint16_t* beyond = partner.data() + first;
#pragma GCC ivdep
    for (std::size_t k = 0; k < first; ++k) {
        out_deviation[k] = larger(d[k], d[beyond[k] - first]);
        out_radius[k] = larger(r[k], r[beyond[k] - first]);
    }
}

}  // namespace planet
