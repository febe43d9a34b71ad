#include "planet/store/bake_resampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "planet/store/coverage.h"

namespace planet {

namespace {

// A field may look at far more samples than lie in a small cap, so few large ones are asked for.
constexpr double most_samples_at_once = 1 << 16;

double triple(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

}  // namespace

float TileResampling::largest(const Surface& surface, std::span<const std::uint8_t> has_tile_below) {
    surface_ = &surface;
    largest_ = 0;
    at_ = 0;
    if (!surface.exists[1]) return 0;
    if (has_tile_below.empty())
        certify(surface.tile.root, 1);
    else
        certify_without_tiles(1, has_tile_below);
    return largest_ > 0 ? std::nextafter(static_cast<float>(largest_), std::numeric_limits<float>::max()) : 0.0f;
}

// The largest cells without a tile below them.
void TileResampling::certify_without_tiles(unsigned local, std::span<const std::uint8_t> has_tile_below) {
    const int levels = tile_levels - relative_level(local);
    const auto below = has_tile_below.subspan((std::size_t{local} << levels) - tile_cells, std::size_t{1} << levels);
    if (std::find(below.begin(), below.end(), 1) == below.end())
        return certify(cell_code(surface_->tile.root, local), local);
    if (levels == 0) return;
    certify_without_tiles(2 * local, has_tile_below);
    certify_without_tiles(2 * local + 1, has_tile_below);
}

// The samples in a cell. @param local the cell, or the one of the tile that holds it
void TileResampling::certify(LocationCode cell, unsigned local) {
    const Cap cap = cap_of(cell);
    const double spacing = surface_->field.spacing(cap);
    if (!std::isfinite(spacing)) return;
    const double across = cap.angle * surface_->placement.ellipsoid.mean_radius();
    const bool too_many = spacing > 0 && std::numbers::pi * across * across > most_samples_at_once * spacing * spacing;
    if (too_many && cell.bisection_level() < max_bisection_level) {
        for (int i = 0; i < 2; ++i)
            certify(cell.child(i), surface_->exists.size() > local && surface_->exists[local]
                                       ? 2 * local + static_cast<unsigned>(i)
                                       : local);
        return;
    }
    normals_.clear();
    heights_.clear();
    surface_->field.samples(cap, normals_, heights_);
    certify_samples(cell, local);
}

void TileResampling::certify_samples(LocationCode cell, unsigned local) {
    const Corners c = corners(cell);
    glm::dvec3 inward[3] = {glm::cross(c.left, c.right), glm::cross(c.right, c.apex), glm::cross(c.apex, c.left)};
    if (!is_counter_clockwise(cell))
        for (glm::dvec3& side : inward) side = -side;
    for (std::size_t s = 0; s < normals_.size(); ++s) {
        const glm::dvec3& n = normals_[s];
        if (glm::dot(inward[0], n) < -1e-15 || glm::dot(inward[1], n) < -1e-15 || glm::dot(inward[2], n) < -1e-15)
            continue;
        const double off = std::abs(static_cast<double>(heights_[s]) - height(finest_cell(local, n), n));
        if (off > largest_) largest_ = off;
    }
}

unsigned TileResampling::finest_cell(unsigned from, const glm::dvec3& n) const {
    const TileLayout& layout = tile_layout();
    bool counter_clockwise = is_counter_clockwise(cell_code(surface_->tile.root, from));
    unsigned local = from;
    for (; local < surface_->exists.size() && surface_->exists[local]; counter_clockwise = !counter_clockwise) {
        // Left is on child 0's side of the plane through the centre, the split vertex and the apex.
        const glm::dvec3 split = surface_->lattice.normal(layout.split_vertex[local]),
                         apex = surface_->lattice.normal(layout.corners[local][2]);
        const double side = glm::dot(n, glm::cross(split, apex));
        local = 2 * local + ((counter_clockwise ? side >= 0 : side <= 0) ? 0 : 1);
    }
    return local;
}

double TileResampling::height(unsigned local, const glm::dvec3& n) {
    const auto& vertex = tile_layout().corners[local];
    const TileLattice& lattice = surface_->lattice;
    if (at_ != local) {
        at_ = local;
        corner_ = lattice.position(vertex[0]);
        plane_ = glm::cross(lattice.position(vertex[1]) - corner_, lattice.position(vertex[2]) - corner_);
    }
    const glm::dvec3 foot = surface_->placement.ecef(n, 0, {});
    const double h = glm::dot(corner_ - foot, plane_) / glm::dot(n, plane_);
    const auto& undulation = surface_->tile.undulation;
    if (undulation.empty()) return h;
    const glm::dvec3 left = lattice.normal(vertex[0]), right = lattice.normal(vertex[1]),
                     apex = lattice.normal(vertex[2]);
    const double l = triple(n, right, apex), r = triple(n, apex, left), a = triple(n, left, right);
    return h - (l * undulation[vertex[0]].m + r * undulation[vertex[1]].m + a * undulation[vertex[2]].m) / (l + r + a);
}

}  // namespace planet
