#pragma once
// The blend along a border of any length: in parts, each made when a place near it is asked for.

#include <functional>
#include <memory>
#include <span>

#include "planet/elevation/border_blend.h"
#include "planet/elevation/elevation_field.h"
#include "planet/elevation/memory_cache.h"

namespace planet {

/// Regions are the squares of a grid on each face of a cube around the planet, about as wide as the reach. The blend of a
/// region has every point of the border that reaches into it, so blends of neighbouring regions differ by no more than
/// what BorderBlend's clusters do. Safe from several threads.
class RegionalBlend {
  public:
    /// Makes the blend for a region within a cap, of the points of the border in a larger one around it. Must be safe from
    /// several threads.
    using Make = std::function<BorderBlend(const Cap& region, const Cap& around)>;

    RegionalBlend() = default;
    /// One blend of all points, made at once.
    explicit RegionalBlend(BorderBlend whole) : whole_(std::make_shared<const BorderBlend>(std::move(whole))) {}
    /// @param reach  chord; nothing farther than this from a point of the border is changed
    /// @param bytes  kept of blends of regions
    RegionalBlend(Make make, double reach, std::size_t bytes);

    /// Whether a reach is small enough for more than a few regions, and large enough to number them.
    static bool has_regions(double reach) { return reach > 4e-6 && reach < 0.05; }

    /// Adds to each correction, in metres, that at a unit normal. @param shares  as BorderBlend::add
    void add(std::span<const glm::dvec3> normals, std::span<double> corrections,
             std::span<BorderShare> shares = {}) const;

  private:
    std::shared_ptr<const BorderBlend> whole_;
    Make make_;
    double reach_ = 0, width_ = 0;  // of a region
    std::unique_ptr<MemoryCache<BorderBlend>> cache_;
};

}  // namespace planet
