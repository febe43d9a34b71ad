#include "planet/bake/packed_heights.h"

#include <algorithm>

#include "planet/lanes.h"

namespace planet {

PackedHeights::PackedHeights(std::span<const float> heights, double quantum_m)
    : quantum_(static_cast<float>(quantum_m)) {
    if (heights.empty()) return;
    const auto [least, most] = least_and_most(heights);
    if ((most - least) / quantum_ > 65535.0f) {
        whole_.assign(heights.begin(), heights.end());
        return;
    }
    least_ = least;
    steps_.resize(heights.size());
    const float one = 1 / quantum_;  // of a power of two: exact
    for (std::size_t v = 0; v < heights.size(); ++v)
        steps_[v] = static_cast<std::uint16_t>(static_cast<std::int32_t>((heights[v] - least) * one));
}

void PackedHeights::unpack(std::vector<float>& heights) const {
    heights = whole_;
    if (!whole_.empty()) return;
    heights.resize(steps_.size());
    for (std::size_t v = 0; v < heights.size(); ++v) heights[v] = least_ + static_cast<float>(steps_[v]) * quantum_;
}

}  // namespace planet
