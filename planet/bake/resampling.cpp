#include "planet/bake/resampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planet/bake/coverage.h"

namespace planet {

namespace {

// A field may look at far more samples than lie in a small cap, so few large ones are asked for.
constexpr double most_samples_at_once = 1 << 16;

}  // namespace

float TileResampling::largest(const Surface& surface, std::span<const std::uint8_t> has_tile_below) {
    if (!surface.exists[1]) return 0;
    distance_.start(surface.placement, surface.tile, surface.lattice, surface.exists, has_tile_below);
    add_without_tiles(surface, surface.tile.root, has_tile_below);
    return distance_.largest();
}

// The largest cells without a tile below them. @param has_tile_below of the cell's part
void TileResampling::add_without_tiles(const Surface& surface, LocationCode cell,
                                       std::span<const std::uint8_t> has_tile_below) {
    if (std::find(has_tile_below.begin(), has_tile_below.end(), 1) == has_tile_below.end()) return add(surface, cell);
    const std::size_t half = has_tile_below.size() / 2;
    if (half == 0) return;
    add_without_tiles(surface, cell.child(0), has_tile_below.first(half));
    add_without_tiles(surface, cell.child(1), has_tile_below.last(half));
}

void TileResampling::add(const Surface& surface, LocationCode cell) {
    const Corners cell_corners = corners(cell);
    const Cap cap = cap_of(cell_corners);
    const double spacing = surface.field.spacing(cap);
    if (!std::isfinite(spacing)) return;
    const double across = cap.angle * surface.placement.ellipsoid.mean_radius();
    const bool too_many = spacing > 0 && std::numbers::pi * across * across > most_samples_at_once * spacing * spacing;
    if (too_many && cell.bisection_level() < max_bisection_level) {
        for (int i = 0; i < 2; ++i) add(surface, cell.child(i));
        return;
    }
    surface.field.sample_rows(SampleArea(cell_corners),
                              [this](std::span<const glm::dvec3> normals, std::span<const float> heights) {
                                  distance_.add(normals, heights);
                              });
}

}  // namespace planet
