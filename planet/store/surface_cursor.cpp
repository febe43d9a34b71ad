#include "planet/store/surface_cursor.h"

#include <algorithm>
#include <cassert>

#include "planet/store/tile_sides.h"

namespace planet {

namespace {

double triple(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

// By root level: whatever the levels at which tiles begin, 0 for a face and one more for each layer below it.
std::size_t layer_of(LocationCode root) {
    return static_cast<std::size_t>((root.bisection_level() + tile_levels - 1) / tile_levels);
}

}  // namespace

SurfaceCursor::SurfaceCursor(const TileReader& tiles, const Placement& placement)
    : tiles_(&tiles), placement_(placement) {
    path_.reserve(max_bisection_level + 1);
}

bool SurfaceCursor::holds(const Step& step, const glm::dvec3& n) const {
    const auto& [left, right, apex] = step.corners;
    const double a = triple(n, left, right), b = triple(n, right, apex), c = triple(n, apex, left);
    return step.counter_clockwise ? a >= 0 && b >= 0 && c >= 0 : a <= 0 && b <= 0 && c <= 0;
}

void SurfaceCursor::start(const glm::dvec3& n) {
    const LocationCode face = cell_at(n, 0);
    held_[0] = tiles_->tile(face);
    assert(held_[0]);
    path_.clear();
    path_.push_back({face_corners(face.face()), held_[0].get(), 1, true, false, {}, {}});
    plane_valid_ = false;
}

// At a cell below the last level of a tile: goes on in the tile that begins there, if there is one.
bool SurfaceCursor::enter_tile_below(Step& step) {
    if (!step.tile->child_exists[step.local - (1u << step.tile->depth)]) return false;
    const LocationCode root = cell_code(step.tile->root, step.local);
    std::shared_ptr<const Tile> below = tiles_->tile(root);
    if (!below || below->damaged || !(below->deviation[1] > 0)) return false;
    step.tile = below.get();
    step.local = 1;
    held_[layer_of(root)] = std::move(below);
    plane_valid_ = false;
    return true;
}

void SurfaceCursor::seek(const glm::dvec3& n, int finest_level) {
    const std::size_t most = static_cast<std::size_t>(finest_level) + 1;
    if (path_.size() > most) {
        path_.resize(most);
        plane_valid_ = false;
    }
    while (!path_.empty() && !holds(path_.back(), n)) {
        path_.pop_back();
        plane_valid_ = false;
    }
    if (path_.empty()) start(n);
    while (path_.size() < most) {
        Step& step = path_.back();
        if (step.local >> step.tile->depth && !enter_tile_below(step)) break;
        if (!(step.tile->deviation[step.local] > 0)) break;
        if (!step.has_split) {
            step.split = split_vertex(step.corners);
            step.middle = glm::cross(step.split, step.corners.apex);
            step.has_split = true;
        }
        // Left is on child 0's side of the plane in the middle.
        const double side = glm::dot(n, step.middle);
        const int child = (step.counter_clockwise ? side >= 0 : side <= 0) ? 0 : 1;
        path_.push_back({child_corners(step.corners, step.split, child),
                         step.tile,
                         2 * step.local + static_cast<unsigned>(child),
                         !step.counter_clockwise,
                         false,
                         {},
                         {}});
        plane_valid_ = false;
    }
}

LocationCode SurfaceCursor::cell() const {
    return cell_code(path_.back().tile->root, path_.back().local);
}

float SurfaceCursor::deviation() const {
    const Step& step = path_.back();
    return step.local >> step.tile->depth ? 0.0f : step.tile->deviation[step.local];
}

void SurfaceCursor::set_plane() {
    const Step& step = path_.back();
    const Tile& tile = *step.tile;
    const auto& vertex = tile_layout().corners[step.local];
    has_undulation_ = !tile.undulation.empty();
    const glm::dvec3* normal[3] = {&step.corners.left, &step.corners.right, &step.corners.apex};
    glm::dvec3 at[3];
    for (int k = 0; k < 3; ++k) {
        const std::size_t v = vertex[static_cast<std::size_t>(k)];
        undulation_[k] = has_undulation_ ? tile.undulation[v].m : 0.0;
        at[k] = placement_.ecef(*normal[k], static_cast<double>(tile.height[v]), {undulation_[k]});
    }
    corner_ = at[0];
    plane_ = glm::cross(at[1] - at[0], at[2] - at[0]);
    plane_valid_ = true;
}

double SurfaceCursor::height(const glm::dvec3& n) {
    if (!plane_valid_) set_plane();
    const glm::dvec3 foot = placement_.ecef(n, 0, {});
    const double h = glm::dot(corner_ - foot, plane_) / glm::dot(n, plane_);
    if (!has_undulation_) return h;
    const auto& [left, right, apex] = path_.back().corners;
    const double l = triple(n, right, apex), r = triple(n, apex, left), a = triple(n, left, right);
    return h - (l * undulation_[0] + r * undulation_[1] + a * undulation_[2]) / (l + r + a);
}

// Of the corners left, right and apex: barycentric where the ray along n meets the plane of their normals. On a side they
// do not depend on the third corner.
glm::dvec3 SurfaceCursor::weights(const glm::dvec3& n) const {
    const auto& [left, right, apex] = path_.back().corners;
    const double l = triple(n, right, apex), r = triple(n, apex, left), a = triple(n, left, right);
    return glm::dvec3(l, r, a) / (l + r + a);
}

double SurfaceCursor::interpolated_height(const glm::dvec3& n) const {
    const Step& step = path_.back();
    const auto& vertex = tile_layout().corners[step.local];
    glm::dvec3 heights;
    for (int k = 0; k < 3; ++k)
        heights[k] = static_cast<double>(step.tile->height[vertex[static_cast<std::size_t>(k)]]);
    return glm::dot(weights(n), heights);
}

SurfaceOrigin SurfaceCursor::origin(const glm::dvec3& n) const {
    constexpr double no_weight = 1e-9;  // what rounding makes of 0
    const Step& step = path_.back();
    SurfaceOrigin from;
    if (!step.tile->origins.known()) return from;
    const glm::dvec3 weight = weights(n);
    std::array<int, 3> corner{0, 1, 2};
    std::stable_sort(corner.begin(), corner.end(), [&](int a, int b) { return weight[a] > weight[b]; });
    const auto& vertex = tile_layout().corners[step.local];
    for (const int k : corner) {
        if (weight[k] <= no_weight) break;
        const HeightOrigin at = step.tile->origins[vertex[static_cast<std::size_t>(k)]];
        for (const std::uint32_t file : {at.file, at.other}) {
            const auto end = from.files.begin() + from.count;
            if (std::find(from.files.begin(), end, file) == end) from.files[from.count++] = file;
        }
    }
    return from;
}

double SurfaceCursor::undulation(const glm::dvec3& n) const {
    const Step& step = path_.back();
    if (step.tile->undulation.empty()) return 0;
    const auto& vertex = tile_layout().corners[step.local];
    glm::dvec3 undulations;
    for (int k = 0; k < 3; ++k) undulations[k] = step.tile->undulation[vertex[static_cast<std::size_t>(k)]].m;
    return glm::dot(weights(n), undulations);
}

}  // namespace planet
