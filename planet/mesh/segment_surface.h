#pragma once
// The drawn triangle above a place: segments, looked up instead of drawn.

#include <optional>
#include <vector>

#include "planet/mesh/segments.h"

namespace planet {

/// Follows segments that stay as they are as long as this is asked. Costs nothing before that; then some 0.3 us a place.
class SegmentSurface {
  public:
    SegmentSurface() = default;
    explicit SegmentSurface(const Segments& segments);

    /// Where the vertical of a place meets its triangle, ecef, metres: exaggerated and as coarse as it is drawn. Nothing
    /// where no segment is. @param normal unit, geodetic
    std::optional<glm::dvec3> point_at(const glm::dvec3& normal);

  private:
    /// Where each leaf of a segment begins, and its triangle.
    struct Leaves {
        std::vector<std::uint64_t> first_code;    ///< at the deepest level of the segment
        std::vector<std::uint32_t> strip_corner;  ///< of the triangle's first index
        int deepest = 0;
    };
    const Segment* segment_at(const glm::dvec3& normal) const;
    const Leaves& leaves_of(const Segment& segment);

    const Segments* segments_ = nullptr;
    std::vector<const Segment*> by_code_;  ///< ascending in the codes of a deepest level
    std::vector<Leaves> leaves_;           ///< by segment; empty: not asked for
};

}  // namespace planet
