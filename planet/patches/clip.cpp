#include "planet/patches/clip.h"

#include <utility>

namespace planet {

namespace {

// Where a side crosses `limit` along an axis.
LatticeVertex cut(LatticeVertex a, LatticeVertex b, int axis, int limit) {
    if (std::pair(a.at.x, a.at.y) > std::pair(b.at.x, b.at.y)) std::swap(a, b);
    const glm::ivec2 d = b.at - a.at;
    const int along = limit - a.at[axis];
    const double s = static_cast<double>(along) / d[axis];
    return {a.at + d / std::abs(d[axis]) * std::abs(along), a.height + (b.height - a.height) * s};
}

// Sutherland and Hodgman's clip against one line.
ClippedTriangle clip_to(const ClippedTriangle& in, int axis, int limit) {
    ClippedTriangle out;
    for (std::size_t i = 0; i < in.count; ++i) {
        const LatticeVertex &a = in.corner[i], &b = in.corner[(i + 1) % in.count];
        const bool a_in = a.at[axis] <= limit, b_in = b.at[axis] <= limit;
        if (a_in) out.corner[out.count++] = a;
        if (a_in != b_in && a.at[axis] != limit && b.at[axis] != limit)
            out.corner[out.count++] = cut(a, b, axis, limit);
    }
    return out;
}

}  // namespace

ClippedTriangle clip(const PatchRaster& raster, const std::array<LatticeVertex, 3>& triangle) {
    ClippedTriangle polygon{{triangle[0], triangle[1], triangle[2]}, 3};
    polygon = clip_to(polygon, 0, raster.width() - 1);
    polygon = clip_to(polygon, 1, raster.height() - 1);
    if (polygon.count < 3) polygon.count = 0;  // touches the border only
    return polygon;
}

}  // namespace planet
