#include "planet/store/baked_tile.h"

#include <algorithm>

namespace planet {

void Saturation::raise(unsigned i) const {
    if (!exists[i]) {
        deviation[i] = radius[i] = 0;
        return;
    }
    if (i >> (depth - 1)) return;
    const glm::vec3& m = rounded[layout.split_vertex[i]];
    double reach = 0;
    for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
        if (!exists[child]) continue;
        deviation[i] = std::max(deviation[i], deviation[child]);
        reach = std::max(reach, radius_over(m, rounded[layout.split_vertex[child]], radius[child]));
    }
    radius[i] = std::max(radius[i], certified_radius(reach));
}

void Saturation::join(unsigned i, unsigned beyond) const {
    deviation[i] = deviation[beyond] = std::max(deviation[i], deviation[beyond]);
    radius[i] = radius[beyond] = std::max(radius[i], radius[beyond]);
}

void corner_radii(const TileLattice& lattice, std::span<const std::uint8_t> exists, bool inner,
                  std::span<const std::uint8_t> lacks_below, std::span<float> radius) {
    const unsigned last = 1u << (lattice.depth() - 1);
    radius[0] = 0;
    for (unsigned i = 1; i < 2 * last; ++i) {
        const bool lacks = i < last ? !(exists[2 * i] && exists[2 * i + 1]) : !inner || lacks_below[i - last];
        radius[i] = exists[i] && lacks ? certified_radius(corner_distance(lattice, i)) : 0.0f;
    }
}

}  // namespace planet
