#include "planet/tin/tin_mending.h"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include "planet/tin/void_border.h"

namespace planet {

namespace {

using Index = Delaunay::Index;
using Side = std::array<glm::ivec2, 2>;

bool before(const Side& s, const Side& t) {
    return std::tie(s[0].x, s[0].y, s[1].x, s[1].y) < std::tie(t[0].x, t[0].y, t[1].x, t[1].y);
}

}  // namespace

TinMending::TinMending(TinMesh mesh)
    : mesh_(std::move(mesh.vertices), mesh.triangles), has_changed_(mesh.triangles.size(), 0) {
    if (!mesh.held_sides.empty()) hold(mesh.held_sides);
}

void TinMending::hold(const std::vector<Side>& sides) {
    std::vector<Side> held;
    for (const auto& [a, b] : sides) held.insert(held.end(), {{a, b}, {b, a}});
    std::ranges::sort(held, before);
    for (Index e = 0; e < 3 * mesh_.triangle_slots(); ++e) {
        const Side side{mesh_.point(mesh_.origin(e)), mesh_.point(mesh_.origin(Delaunay::next(e)))};
        if (std::ranges::binary_search(held, side, before)) mesh_.hold(e);
    }
}

bool TinMending::insert(glm::ivec2 sample, std::uint32_t triangle) {
    if (has_changed_[triangle]) return false;
    const Delaunay::Location at = mesh_.locate_in(sample, triangle);
    assert(at.vertex == Delaunay::none);
    mesh_.insert(sample, at);
    has_changed_.resize(mesh_.triangle_slots(), 0);
    for (const Index t : mesh_.changed()) {
        if (has_changed_[t]) continue;
        has_changed_[t] = 1;
        changed_.push_back(t);
    }
    return true;
}

std::vector<std::uint32_t> TinMending::take_changed() {
    for (const Index t : changed_) has_changed_[t] = 0;
    std::ranges::sort(changed_);
    return std::exchange(changed_, {});
}

TinMesh TinMending::mesh(const HeightGrid& grid) const {
    return triangles_over_samples(mesh_, grid);
}

}  // namespace planet
