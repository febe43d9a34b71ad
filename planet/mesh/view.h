#pragma once
// The split test of a view: what must be finer, seen from where.

#include <glm/glm.hpp>

#include "planet/mesh/placed_tile.h"

namespace planet {

/// **Split iff deviation > 0 and |eye - m| < radius + K deviation.** With the saturated numbers of a SplitRecord the
/// test is nested: a vertex passes only if its parents pass, so every walk yields a conforming mesh with no closure and
/// no memory. After Lindstrom and Pascucci, "Terrain Simplification Simplified" (2002), with radii per diamond.
struct SplitTest {
    glm::dvec3 eye{0};
    double K = 0;  ///< metres of distance per metre of deviation: f_px (1 + tan^2 corner) / max_pixel_deviation

    bool operator()(const SplitRecord& s) const {
        const double dx = eye.x - static_cast<double>(s.x), dy = eye.y - static_cast<double>(s.y),
                     dz = eye.z - static_cast<double>(s.z);
        const double reach = static_cast<double>(s.radius) + K * static_cast<double>(s.deviation);
        return s.deviation > 0 && dx * dx + dy * dy + dz * dz < reach * reach;
    }
};

/// K of a perspective picture. @param focal_px focal length in pixels @param tan_corner tangent of the angle between
/// the view axis and a corner @param max_pixel_deviation > 0. The corner term bounds the projected deviation at every
/// pixel whatever the view direction: off the axis by theta a length across the view is stretched by up to 1 + tan^2
/// theta.
inline double split_reach(double focal_px, double tan_corner, double max_pixel_deviation) {
    return focal_px * (1.0 + tan_corner * tan_corner) / max_pixel_deviation;
}

}  // namespace planet
