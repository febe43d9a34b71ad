#include <algorithm>
#include <numeric>

#include "planet/bisection/progressive.h"

namespace planet {

namespace {

using Index = Progressive::Index;

// Base triangles in a leaf of the tree of boxes.
constexpr std::size_t leaf_size = 2;

double orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

}  // namespace

PointLocator::PointLocator(const Progressive& mesh) : mesh_(mesh), order_(mesh.base().triangles.size()) {
    std::iota(order_.begin(), order_.end(), Index{0});
    build(0, 0, order_.size());
}

void PointLocator::build(std::size_t node, std::size_t begin, std::size_t end) {
    if (boxes_.size() <= node) boxes_.resize(node + 1);
    const auto middle_of = [&](Index t) {
        const auto& c = mesh_.base().triangles[t];
        return glm::dvec2(mesh_.place(c[0]) + mesh_.place(c[1]) + mesh_.place(c[2]));
    };
    Box box{glm::dvec2(std::numeric_limits<double>::infinity()), glm::dvec2(-std::numeric_limits<double>::infinity())};
    for (std::size_t i = begin; i < end; ++i)
        for (const Index v : mesh_.base().triangles[order_[i]]) {
            box.low = glm::min(box.low, glm::dvec2(mesh_.place(v)));
            box.high = glm::max(box.high, glm::dvec2(mesh_.place(v)));
        }
    boxes_[node] = box;
    if (end - begin <= leaf_size) return;
    const int axis = box.high.x - box.low.x >= box.high.y - box.low.y ? 0 : 1;
    const std::size_t half = begin + (end - begin + 1) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(half), at(end), [&](Index a, Index b) {
        const double x = middle_of(a)[axis], y = middle_of(b)[axis];
        return x != y ? x < y : a < b;
    });
    build(2 * node + 1, begin, half);
    build(2 * node + 2, half, end);
}

bool PointLocator::base_holds(Index t, glm::dvec2 point) const {
    const auto& c = mesh_.base().triangles[t];
    const glm::dvec2 p[3] = {mesh_.place(c[0]), mesh_.place(c[1]), mesh_.place(c[2])};
    const double turn = orientation(p[0], p[1], p[2]);
    for (int k = 0; k < 3; ++k)
        if (orientation(p[k], p[(k + 1) % 3], point) * turn < 0) return false;
    return true;
}

std::optional<Index> PointLocator::base_triangle(glm::dvec2 point, int& comparisons) const {
    struct Part {
        std::size_t node, begin, end;
    };
    std::vector<Part> stack = {{0, 0, order_.size()}};
    while (!stack.empty()) {
        const Part part = stack.back();
        stack.pop_back();
        const Box& box = boxes_[part.node];
        ++comparisons;
        if (point.x < box.low.x || point.y < box.low.y || point.x > box.high.x || point.y > box.high.y) continue;
        if (part.end - part.begin <= leaf_size) {
            for (std::size_t i = part.begin; i < part.end; ++i) {
                comparisons += 3;
                if (base_holds(order_[i], point)) return order_[i];
            }
            continue;
        }
        const std::size_t half = part.begin + (part.end - part.begin + 1) / 2;
        stack.push_back({2 * part.node + 1, part.begin, half});
        stack.push_back({2 * part.node + 2, half, part.end});
    }
    return std::nullopt;
}

std::optional<PointLocator::Found> PointLocator::locate(const Selection& selection, glm::dvec2 point) const {
    Found found{};
    const auto base = base_triangle(point, found.comparisons);
    if (!base) return std::nullopt;
    found.name = *base;
    found.corners = mesh_.base_corners(*base);
    const auto at = [&](Index v) { return glm::dvec2(mesh_.place(v)); };
    const double turn = orientation(at(found.corners[0]), at(found.corners[1]), at(found.corners[2])) < 0 ? -1 : 1;
    const auto left = [&](Index a, Index b) {
        ++found.comparisons;
        return turn * orientation(at(a), at(b), point) >= 0;
    };
    for (;; ++found.depth) {
        const Selection::Children below = selection.children(found.name);
        if (below.count == 0) return found;
        std::size_t next = 0;
        if (below.count == 2) {
            // Halves (a, v, c) and (v, b, c): the second is on the left of c-v.
            next = left(below.child[0].corners[2], below.child[0].corners[1]) ? 1 : 0;
        } else {
            // Of four, the middle one (A', B', C') is on the left of all its sides; those at A, B, C lie beyond them.
            const auto& [a1, b1, c1] = below.child[3].corners;
            next = !left(b1, c1) ? 0 : !left(c1, a1) ? 1 : !left(a1, b1) ? 2 : 3;
        }
        found.name = below.child[next].name;
        found.corners = below.child[next].corners;
    }
}

}  // namespace planet
