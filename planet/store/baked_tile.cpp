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

}  // namespace planet
