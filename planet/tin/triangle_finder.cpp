#include "planet/tin/triangle_finder.h"

#include <algorithm>
#include <cmath>

namespace planet {

namespace {

using Index = Delaunay::Index;

class NaiveFinder : public TriangleFinder {
  public:
    void update(const Delaunay&, std::span<const Index>) override {}
    Index find(const Delaunay& mesh, glm::ivec2 sample) const override {
        for (Index t = 0; t < mesh.triangle_slots(); ++t)
            if (mesh.alive(t) && holds(mesh, t, sample)) return t;
        return Delaunay::none;
    }
};

struct Circle {
    glm::dvec2 centre;
    double radius;
};

// A little larger than it is, so that rounding loses nothing.
Circle circumcircle(const std::array<glm::ivec2, 3>& c) {
    const glm::dvec2 u(c[1] - c[0]), v(c[2] - c[0]);
    const double scale = 0.5 / (u.x * v.y - u.y * v.x), uu = glm::dot(u, u), vv = glm::dot(v, v);
    const glm::dvec2 centre((uu * v.y - vv * u.y) * scale, (vv * u.x - uu * v.x) * scale);
    return {glm::dvec2(c[0]) + centre, glm::length(centre) * (1 + 1e-9) + 1e-6};
}

class CellFinder : public TriangleFinder {
  public:
    CellFinder(glm::ivec2 low, glm::ivec2 high) : low_(low), cell_(glm::dvec2(high - low + 1) / double{side}) {}

    void update(const Delaunay& mesh, std::span<const Index> changed) override {
        reach_.resize(mesh.triangle_slots());
        for (const Index t : changed) {
            for_each_cell(reach_[t], [&](std::vector<Index>& list, glm::dvec2) {
                const auto at = std::lower_bound(list.begin(), list.end(), t);
                if (at != list.end() && *at == t) list.erase(at);
            });
            const Circle circle = circumcircle(mesh.corners(t));
            reach_[t] = {cell_of(circle.centre - circle.radius), cell_of(circle.centre + circle.radius)};
            for_each_cell(reach_[t], [&](std::vector<Index>& list, glm::dvec2 corner) {
                const glm::dvec2 nearest = glm::clamp(circle.centre, corner, corner + cell_);
                if (glm::distance(nearest, circle.centre) > circle.radius) return;
                list.insert(std::lower_bound(list.begin(), list.end(), t), t);
            });
        }
    }

    Index find(const Delaunay& mesh, glm::ivec2 sample) const override {
        const glm::ivec2 cell = cell_of(glm::dvec2(sample));
        for (const Index t : lists_[static_cast<std::size_t>(cell.y * side + cell.x)])
            if (holds(mesh, t, sample)) return t;
        return Delaunay::none;
    }

  private:
    static constexpr int side = 16;
    struct Reach {
        glm::ivec2 low{0}, high{-1};  ///< cells, both included
    };

    glm::ivec2 cell_of(glm::dvec2 p) const {
        return glm::ivec2(glm::clamp(glm::floor((p - glm::dvec2(low_)) / cell_), 0.0, double{side - 1}));
    }
    template <class What>
    void for_each_cell(const Reach& reach, What&& what) {
        for (int y = reach.low.y; y <= reach.high.y; ++y)
            for (int x = reach.low.x; x <= reach.high.x; ++x)
                what(lists_[static_cast<std::size_t>(y * side + x)], glm::dvec2(low_) + glm::dvec2(x, y) * cell_);
    }

    glm::ivec2 low_;
    glm::dvec2 cell_;                                                 ///< its size
    std::array<std::vector<Index>, std::size_t{side} * side> lists_;  ///< ascending
    std::vector<Reach> reach_;                                        ///< by triangle
};

}  // namespace

bool holds(const Delaunay& mesh, Delaunay::Index triangle, glm::ivec2 p) {
    const auto c = mesh.corners(triangle);
    return orientation(c[0], c[1], p) >= 0 && orientation(c[1], c[2], p) >= 0 && orientation(c[2], c[0], p) >= 0;
}

std::unique_ptr<TriangleFinder> make_naive_finder() {
    return std::make_unique<NaiveFinder>();
}

std::unique_ptr<TriangleFinder> make_cell_finder(glm::ivec2 low, glm::ivec2 high) {
    return std::make_unique<CellFinder>(low, high);
}

}  // namespace planet
