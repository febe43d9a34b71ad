#include "planet/elevation/regional_blend.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace planet {
namespace {

constexpr int coordinate_bits = 21;  // of a region

}  // namespace

RegionalBlend::RegionalBlend(Make make, double reach, std::size_t bytes)
    : make_(std::move(make)),
      reach_(reach),
      width_(2 * reach),
      cache_(std::make_unique<MemoryCache<BorderBlend>>(bytes)) {
    assert(has_regions(reach));
}

void RegionalBlend::add(std::span<const glm::dvec3> normals, std::span<double> corrections) const {
    assert(corrections.size() == normals.size());
    if (whole_) {
        for (std::size_t i = 0; i < normals.size(); ++i) corrections[i] += (*whole_)(normals[i]);
        return;
    }
    if (!make_) return;
    glm::dvec3 held(std::numeric_limits<double>::quiet_NaN());  // the region that `blend` is of
    std::shared_ptr<const BorderBlend> blend;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(normals[i].x + normals[i].y + normals[i].z)) continue;
        const glm::dvec3 region = glm::floor((normals[i] + 1.0) / width_);
        if (region != held) {
            std::uint64_t key = 0;
            for (int axis = 0; axis < 3; ++axis)
                key = key << coordinate_bits | static_cast<std::uint64_t>(region[axis]);
            const glm::dvec3 centre = glm::normalize((region + 0.5) * width_ - 1.0);
            // Half a diagonal from any place in the cube to its middle, and as much from there to the sphere.
            const double chord = std::sqrt(3.0) * width_ + reach_;
            blend = cache_->get(key, [&] { return make_({centre, 2 * std::asin(std::min(1.0, 0.5 * chord))}); });
            held = region;
        }
        corrections[i] += (*blend)(normals[i]);
    }
}

}  // namespace planet
