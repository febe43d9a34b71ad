#include "planet/mesh/segment_surface.h"

#include <algorithm>
#include <cassert>

#include "planet/geodesy/ellipsoid.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

namespace {

std::uint64_t first_code(const Segment& s) {
    return s.root.first_at(max_bisection_level);
}

}  // namespace

SegmentSurface::SegmentSurface(const Segments& segments) : segments_(&segments), leaves_(segments.segments().size()) {
    by_code_.reserve(leaves_.size());
    for (const Segment& s : segments.segments()) by_code_.push_back(&s);
    std::ranges::sort(by_code_, {}, [](const Segment* s) { return first_code(*s); });
}

const Segment* SegmentSurface::segment_at(const glm::dvec3& normal) const {
    const LocationCode cell = cell_at(normal, max_bisection_level);
    const auto after =
        std::ranges::upper_bound(by_code_, cell.bits(), {}, [](const Segment* s) { return first_code(*s); });
    if (after == by_code_.begin()) return nullptr;
    const Segment* s = *std::prev(after);
    return s->root.contains(cell) ? s : nullptr;
}

const SegmentSurface::Leaves& SegmentSurface::leaves_of(const Segment& segment) {
    Leaves& leaves = leaves_[static_cast<std::size_t>(&segment - segments_->segments().data())];
    if (!leaves.first_code.empty()) return leaves;
    const auto levels = segments_->leaf_levels().subspan(segment.first_leaf, segment.leaves);
    leaves.deepest = *std::ranges::max_element(levels);
    std::uint64_t code = segment.root.first_at(leaves.deepest);
    for (const std::uint8_t level : levels) {
        leaves.first_code.push_back(code);
        code += std::uint64_t{1} << (leaves.deepest - level);
    }
    const std::uint32_t* index = segments_->indices().data() + segment.first_index;
    for (std::uint32_t i = 0; i + 2 < segment.index_count; ++i)
        if (index[i] != index[i + 1] && index[i + 1] != index[i + 2] && index[i] != index[i + 2])
            leaves.strip_corner.push_back(i);
    assert(leaves.strip_corner.size() == levels.size());
    return leaves;
}

std::optional<glm::dvec3> SegmentSurface::point_at(const glm::dvec3& normal) {
    const Segment* s = segments_ != nullptr ? segment_at(normal) : nullptr;
    if (s == nullptr || s->leaves == 0) return std::nullopt;
    const Leaves& leaves = leaves_of(*s);
    const std::uint64_t code = cell_at(normal, leaves.deepest).bits();
    const auto leaf = std::ranges::upper_bound(leaves.first_code, code) - leaves.first_code.begin() - 1;
    const std::uint32_t* index =
        segments_->indices().data() + s->first_index + leaves.strip_corner[static_cast<std::size_t>(leaf)];
    const auto corner = [&](int k) {
        return ecef_from_grid(segments_->vertices()[s->first_vertex + index[k]].position);
    };
    const glm::dvec3 a = corner(0), across = glm::cross(corner(1) - a, corner(2) - a);
    const glm::dvec3 foot = ecef_from_normal(wgs84, normal);
    const double along = glm::dot(across, normal);
    if (along == 0) return std::nullopt;
    return foot + glm::dot(across, a - foot) / along * normal;
}

}  // namespace planet
