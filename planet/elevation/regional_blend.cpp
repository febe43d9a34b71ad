#include "planet/elevation/regional_blend.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace planet {
namespace {

constexpr int coordinate_bits = 30;  // of a region, in each direction

struct Region {
    int axis = -1;         // of the cube's face
    bool positive = true;  // which of two
    glm::dvec2 cell{0};
    bool operator==(const Region&) const = default;
};

Region region_of(const glm::dvec3& n, double width) {
    const glm::dvec3 a = glm::abs(n);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const glm::dvec2 on_face = glm::dvec2(n[(axis + 1) % 3], n[(axis + 2) % 3]) / a[axis];
    return {axis, n[axis] > 0, glm::floor((on_face + 1.0) / width)};
}

glm::dvec3 place_in(const Region& region, double width, glm::dvec2 part) {
    const glm::dvec2 on_face = (region.cell + part) * width - 1.0;
    glm::dvec3 n;
    n[region.axis] = region.positive ? 1 : -1;
    n[(region.axis + 1) % 3] = on_face.x;
    n[(region.axis + 2) % 3] = on_face.y;
    return glm::normalize(n);
}

std::uint64_t key_of(const Region& region) {
    std::uint64_t key = static_cast<std::uint64_t>(2 * region.axis + (region.positive ? 1 : 0));
    for (int i = 0; i < 2; ++i) key = key << coordinate_bits | static_cast<std::uint64_t>(region.cell[i]);
    return key;
}

// Around a square, whose sides are great circles: no place in it is farther from the middle than a corner.
Cap cap_of(const Region& region, double width, double beyond) {
    const glm::dvec3 centre = place_in(region, width, {0.5, 0.5});
    double chord = 0;
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(0, 1), glm::dvec2(1, 0), glm::dvec2(1, 1)})
        chord = std::max(chord, glm::distance(centre, place_in(region, width, corner)));
    return {centre, 2 * std::asin(std::min(1.0, 0.5 * (chord * (1 + 1e-9) + beyond)))};
}

}  // namespace

RegionalBlend::RegionalBlend(Make make, double reach, std::size_t bytes)
    : make_(std::move(make)), reach_(reach), width_(reach), cache_(std::make_unique<MemoryCache<BorderBlend>>(bytes)) {
    assert(has_regions(reach));
}

void RegionalBlend::add(std::span<const glm::dvec3> normals, std::span<double> corrections,
                        std::span<BorderShare> shares) const {
    assert(corrections.size() == normals.size());
    if (whole_) {
        whole_->add(normals, corrections, shares);
        return;
    }
    if (!make_) return;
    Region held;  // that `blend` is of
    std::shared_ptr<const BorderBlend> blend;
    std::size_t first = 0;  // of those in the region held
    const auto add_held = [&](std::size_t end) {
        const std::size_t n = end - first;
        if (blend)
            blend->add(normals.subspan(first, n), corrections.subspan(first, n),
                       shares.empty() ? shares : shares.subspan(first, n));
        first = end;
    };
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(normals[i].x + normals[i].y + normals[i].z)) continue;  // changes nothing, in any region
        const Region region = region_of(normals[i], width_);
        if (region == held) continue;
        add_held(i);
        blend = cache_->get(key_of(region),
                            [&] { return make_(cap_of(region, width_, 0), cap_of(region, width_, reach_)); });
        held = region;
    }
    add_held(normals.size());
}

}  // namespace planet
