#pragma once
// The split test of a view: what must be finer, seen from where.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "planet/mesh/placed_tile.h"

namespace planet {

/// **Split iff deviation > 0 and |eye - m| < radius + K deviation.** With the saturated numbers of a SplitRecord the
/// test is nested: a vertex passes only if its parents pass, so every walk yields a conforming mesh with no closure and
/// no memory. After Lindstrom and Pascucci, "Terrain Simplification Simplified" (2002), with radii per diamond.
struct SplitTest {
    glm::dvec3 eye{0};
    double K = 0;  ///< metres of distance per metre of deviation: f_px (1 + tan^2 corner) / max_pixel_deviation

    bool operator()(const SplitRecord& s) const {
        const double r = reach(s);
        return s.deviation > 0 && distance2(s) < r * r;
    }
    /// |eye - m|^2
    double distance2(const SplitRecord& s) const {
        const double dx = eye.x - static_cast<double>(s.x), dy = eye.y - static_cast<double>(s.y),
                     dz = eye.z - static_cast<double>(s.z);
        return dx * dx + dy * dy + dz * dz;
    }
    double reach(const SplitRecord& s) const {
        return static_cast<double>(s.radius) + K * static_cast<double>(s.deviation);
    }
};

/// Slack: how far an eye may move, in any direction, before an answer of a set of comparisons "|eye - m| < reach" can
/// change. That is the least | |eye - m| - reach |, less what rounding may turn over.
class Slack {
  public:
    explicit Slack(const glm::dvec3& eye) : rounding_(2e-14 * (glm::length(eye) + farthest_m)) {}

    /// @param distance2 |eye - m|^2 as computed for the comparison. Costs two products unless the slack gets less.
    void add(double distance2, double reach) {
        const double inner = std::max(reach - least_, 0.0), outer = reach + least_;
        if (distance2 >= inner * inner && distance2 < outer * outer) [[unlikely]]
            least_ = std::min(least_, std::abs(std::sqrt(distance2) - reach));
    }

    void add(const SplitTest& test, const SplitRecord& s) {
        if (s.deviation > 0) add(test.distance2(s), test.reach(s));
    }

    /// @param margin | |eye - m| - reach | as computed, metres
    void add_margin(double margin) { least_ = std::min(least_, margin); }

    /// Metres, >= 0; infinity if nothing was compared. In doubles |eye - m| and reach are good to 1e-15 of themselves, and
    /// where they are near each other both are at most |eye| + farthest_m + slack: what is taken off covers that ten times.
    double metres() const { return std::max(0.0, least_ * (1 - 1e-14) - rounding_); }

  private:
    static constexpr double farthest_m = 1.5e7;  ///< from the planet's centre is no vertex: it fits the grid
    double least_ = std::numeric_limits<double>::infinity();
    double rounding_;
};

/// K of a perspective picture. @param focal_px focal length in pixels @param tan_corner tangent of the angle between
/// the view axis and a corner @param max_pixel_deviation > 0. The corner term bounds the projected deviation at every
/// pixel whatever the view direction: off the axis by theta a length across the view is stretched by up to 1 + tan^2
/// theta.
inline double split_reach(double focal_px, double tan_corner, double max_pixel_deviation) {
    return focal_px * (1.0 + tan_corner * tan_corner) / max_pixel_deviation;
}

}  // namespace planet
