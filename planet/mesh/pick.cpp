#include "planet/mesh/pick.h"

#include "planet/mesh/refine.h"

namespace planet {

namespace {

class Picker {
  public:
    Picker(const TileSource& tiles, const SplitTest& test, const glm::dvec3& origin, const glm::dvec3& direction)
        : tiles_(tiles),
          test_(test),
          origin_(origin),
          direction_(direction),
          length2_(glm::dot(direction, direction)) {}

    std::optional<Pick> planet() {
        for (int face = 0; face < face_count; ++face)
            if (const PlacedTile* tile = tiles_.tile(LocationCode::face_root(face))) cell(*tile, 1);
        return found_;
    }

  private:
    // The same order of tests as in Walk (refine.h): the same leaves.
    void cell(const PlacedTile& t, unsigned i) {
        if (i >> t.depth) {
            const PlacedTile* child = t.child(tiles_, t.position_below(i), test_);
            if (child && test_(child->split[1])) {
                halves(*child, 1);
                return;
            }
            leaf(t, i);
        } else if (test_(t.split[i])) {
            halves(t, i);
        } else {
            leaf(t, i);
        }
    }

    void halves(const PlacedTile& t, unsigned i) {
        if (!meets(t.split[i])) return;
        cell(t, 2 * i);
        cell(t, 2 * i + 1);
    }

    // Every vertex below a diamond, and so every triangle, is in its sphere.
    bool meets(const SplitRecord& s) const {
        const glm::dvec3 to(static_cast<double>(s.x) - origin_.x, static_cast<double>(s.y) - origin_.y,
                            static_cast<double>(s.z) - origin_.z);
        const double radius = static_cast<double>(s.radius) * (1 + 1e-6) + 1;
        const double along = glm::dot(to, direction_) / length2_;
        const glm::dvec3 aside = to - along * direction_;
        if (glm::dot(aside, aside) > radius * radius) return false;
        const double reach = radius / std::sqrt(length2_);
        return along >= -reach && !(found_ && along - reach > found_->distance);
    }

    // Möller and Trumbore, "Fast, minimum storage ray/triangle intersection" (1997), relative to the origin.
    void leaf(const PlacedTile& t, unsigned i) {
        const auto& vertex = tile_layout().corners[i];
        const glm::dvec3 a = ecef_from_grid(t.position[vertex[0]]) - origin_,
                         b = ecef_from_grid(t.position[vertex[1]]) - origin_,
                         c = ecef_from_grid(t.position[vertex[2]]) - origin_;
        const glm::dvec3 ab = b - a, ac = c - a, p = glm::cross(direction_, ac);
        const double volume = glm::dot(ab, p);
        if (volume == 0) return;
        constexpr double slack = 1e-9;  // of a side: a ray between two triangles meets one of them
        const double right = -glm::dot(a, p) / volume;
        const glm::dvec3 q = glm::cross(-a, ab);
        const double apex = glm::dot(direction_, q) / volume;
        if (right < -slack || apex < -slack || right + apex > 1 + slack) return;
        const double distance = glm::dot(ac, q) / volume;
        if (!(distance >= 0) || (found_ && found_->distance <= distance)) return;
        const glm::dvec3 weights(1 - right - apex, right, apex);
        const glm::dvec3 heights(static_cast<double>(t.height[vertex[0]]), static_cast<double>(t.height[vertex[1]]),
                                 static_cast<double>(t.height[vertex[2]]));
        found_ = {distance, origin_ + distance * direction_, code_of(t, i),
                  weights,  glm::dot(weights, heights),      deviation_of(t, i)};
    }

    // Below 0 in a record: a diamond of the store that has no tile in memory.
    static double deviation_of(const PlacedTile& t, unsigned i) {
        if (i >> t.depth == 0) return std::abs(static_cast<double>(t.split[i].deviation));
        return std::abs(static_cast<double>(t.child_bound[t.position_below(i)].deviation));
    }

    const TileSource& tiles_;
    const SplitTest& test_;
    glm::dvec3 origin_, direction_;
    double length2_;
    std::optional<Pick> found_;
};

}  // namespace

std::optional<Pick> pick(const TileSource& tiles, const SplitTest& test, const glm::dvec3& origin,
                         const glm::dvec3& direction) {
    return Picker(tiles, test, origin, direction).planet();
}

}  // namespace planet
