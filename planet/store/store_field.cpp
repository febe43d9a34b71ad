#include "planet/store/store_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/octahedron/cell_metrics.h"

namespace planet {

namespace {

bool is_direction(const glm::dvec3& n) {
    const double square = glm::dot(n, n);
    return square > 0 && std::isfinite(square);
}

bool meet(const Cap& a, const Cap& b) {
    // The angle by atan2: exact for small ones too.
    const double apart = std::atan2(glm::length(glm::cross(a.centre, b.centre)), glm::dot(a.centre, b.centre));
    return apart <= a.angle + b.angle;
}

}  // namespace

StoreField::StoreField(std::shared_ptr<const ElevationStore> store, std::size_t memory_bytes)
    : store_(std::move(store)), cache_(*store_, memory_bytes) {}

SurfaceCursor StoreField::cursor() const {
    return {cache_, Placement{store_->metadata().ellipsoid, 1.0}};
}

void StoreField::heights(std::span<const glm::dvec3> normals, std::span<float> out) const {
    SurfaceCursor at = cursor();
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (!is_direction(normals[i])) {
            out[i] = std::numeric_limits<float>::quiet_NaN();
            continue;
        }
        at.seek(normals[i]);
        out[i] = static_cast<float>(at.height(normals[i]));
    }
}

void StoreField::heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                                      std::span<WeighedOrigin> origins) const {
    heights(normals, out);
    SurfaceCursor at = cursor();
    for (std::size_t i = 0; i < normals.size(); ++i) {
        origins[i] = {{1, 1}, 1};
        if (!is_direction(normals[i])) continue;
        at.seek(normals[i]);
        const SurfaceOrigin from = at.origin(normals[i]);
        if (from.count > 0) origins[i].origin = {from.files[0], from.files[from.count > 1 ? 1 : 0]};
    }
}

float StoreField::height_at(const glm::dvec3& normal, int bisection_level) const {
    if (!is_direction(normal)) return std::numeric_limits<float>::quiet_NaN();
    SurfaceCursor at = cursor();
    at.seek(normal, bisection_level);
    return static_cast<float>(at.height(normal));
}

SurfaceBound StoreField::bound_at(const glm::dvec3& normal, int bisection_level) const {
    if (!is_direction(normal)) return {std::numeric_limits<double>::quiet_NaN(), 0};
    SurfaceCursor at = cursor();
    at.seek(normal);
    SurfaceBound bound{static_cast<double>(at.tile().resampling), 0};
    if (at.cell().bisection_level() > bisection_level) {
        at.seek(normal, bisection_level);
        bound.deviation = static_cast<double>(at.deviation());
    }
    return bound;
}

double StoreField::spacing(const Cap& cap) const {
    int finest = 0;
    for (int face = 0; face < face_count; ++face)
        finest = std::max(finest, finest_level_in(cap, LocationCode::face_root(face), finest));
    return cell_metrics(finest).vertex_spacing * store_->metadata().ellipsoid.mean_radius();
}

int StoreField::finest_level_in(const Cap& cap, LocationCode root, int known) const {
    if (known >= store_->metadata().finest_level || !meet(cap, cap_of(root))) return known;
    const std::shared_ptr<const Tile> tile = cache_.tile(root);
    if (!tile) return known;
    known = std::max(known, root.bisection_level() + tile->depth);
    if (tile->child_exists.none()) return known;
    // Down to the cells that meet the cap, rather than each of up to 4096.
    std::vector<LocationCode> open{root};
    while (!open.empty()) {
        const LocationCode cell = open.back();
        open.pop_back();
        if (!meet(cap, cap_of(cell))) continue;
        if (cell.bisection_level() < root.bisection_level() + tile->depth) {
            open.push_back(cell.child(1));
            open.push_back(cell.child(0));
        } else if (tile->child_exists[cell.bits() & ((std::uint64_t{1} << tile->depth) - 1)]) {
            known = finest_level_in(cap, cell, known);
            if (known >= store_->metadata().finest_level) return known;
        }
    }
    return known;
}

}  // namespace planet
