#include "planet/mesh/saturation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace planet {

namespace {

// Pairs of cells that share their split side inside the tile, by level of the cells, the lesser first.
struct Pairs {
    std::vector<std::array<std::uint16_t, 2>> cells;
    std::array<std::size_t, tile_levels + 1> first{};
};

Pairs make_pairs() {
    Pairs p;
    for (int level = 0; level < tile_levels; ++level) {
        p.first[static_cast<std::size_t>(level)] = p.cells.size();
        for (unsigned i = 1u << level; i < 2u << level; ++i)
            if (const std::uint16_t beyond = tile_layout().split_neighbor[i]; i < beyond)
                p.cells.push_back({static_cast<std::uint16_t>(i), beyond});
    }
    p.first[tile_levels] = p.cells.size();
    return p;
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
    const auto& split_vertex = tile_layout().split_vertex;
    for (std::size_t i = 1; i < cells; ++i) {
        const glm::vec3& m = rounded[split_vertex[i]];
        x_[i] = m.x;
        y_[i] = m.y;
        z_[i] = m.z;
    }
}

// Over the diamonds of the two children. One that does not exist has a record of zeros, and does not count.
void TileSaturation::raise(unsigned first, float* deviation, float* radius) const {
    const float *x = x_.data(), *y = y_.data(), *z = z_.data();
    const auto reach = [&](std::size_t i, std::size_t child) {
        const double r = radius_over({x[i], y[i], z[i]}, {x[child], y[child], z[child]}, radius[child]);
        return deviation[child] > 0 ? r : 0.0;
    };
#pragma GCC ivdep
    for (std::size_t i = first; i < 2 * std::size_t{first}; ++i) {
        const double r0 = reach(i, 2 * i), r1 = reach(i, 2 * i + 1);
        const float r = certified_radius(r0 > r1 ? r0 : r1);
        deviation[i] = larger(deviation[i], larger(deviation[2 * i], deviation[2 * i + 1]));
        radius[i] = larger(radius[i], r);
    }
}

void TileSaturation::level(int level, std::span<const std::uint8_t> exists, std::span<float> deviation,
                           std::span<float> radius) const {
    static const Pairs pairs = make_pairs();
    const unsigned first = 1u << level;
    if (level < depth_ - 1) raise(first, deviation.data(), radius.data());
    if (std::memchr(exists.data() + first, 0, first) != nullptr)
        for (unsigned i = first; i < 2 * first; ++i)
            if (!exists[i]) deviation[i] = radius[i] = 0;
    float *d = deviation.data(), *r = radius.data();
    const auto l = static_cast<std::size_t>(level);
    for (std::size_t k = pairs.first[l]; k < pairs.first[l + 1]; ++k) {
        const auto [i, beyond] = pairs.cells[k];
        d[i] = d[beyond] = larger(d[i], d[beyond]);
        r[i] = r[beyond] = larger(r[i], r[beyond]);
    }
}

}  // namespace planet
