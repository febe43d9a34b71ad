#include "planet/elevation/border_blend.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace planet {
namespace {

constexpr int leaf_points = 8;
constexpr double closest = 1e-12;  // chord: 6 micrometres on Earth

// At least 0, and monotonic in r.
double weight(double r, double reach) {
    if (r >= reach) return 0;
    const double w = (reach - r) / (reach * std::max(r, closest));
    return w * w;
}

}  // namespace

BorderBlend::BorderBlend(std::vector<Point> points, double clearance)
    : points_(std::move(points)), clearance_(clearance) {
    if (!points_.empty()) build(0, static_cast<int>(points_.size()));
}

void BorderBlend::build(int first, int count) {
    const auto begin = points_.begin() + first, end = begin + count;
    Node node;
    node.first = first;
    node.count = count;
    glm::dvec3 low = begin->normal, high = low;
    node.centre = glm::dvec3(0);
    for (auto p = begin; p != end; ++p) {
        low = glm::min(low, p->normal);
        high = glm::max(high, p->normal);
        node.centre += p->count * p->normal;
        node.difference += p->count * p->difference;
        node.reach += p->count * p->reach;
        node.weight += p->count;
        node.max_reach = std::max(node.max_reach, p->reach);
    }
    node.centre /= node.weight;
    node.difference /= node.weight;
    node.reach /= node.weight;
    for (auto p = begin; p != end; ++p) node.radius = std::max(node.radius, glm::distance(p->normal, node.centre));
    const std::size_t index = nodes_.size();
    nodes_.push_back(node);
    if (count <= leaf_points) return;
    const glm::dvec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int half = count / 2;
    std::nth_element(begin, begin + half, end,
                     [axis](const Point& a, const Point& b) { return a.normal[axis] < b.normal[axis]; });
    build(first, half);
    nodes_[index].right = static_cast<int>(nodes_.size());
    build(first + half, count - half);
}

void BorderBlend::find_nearest(std::size_t index, const glm::dvec3& p, double& least) const {
    const Node& node = nodes_[index];
    if (glm::distance(p, node.centre) - node.radius - clearance_ >= least * node.max_reach) return;
    if (node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) {
            const Point& q = points_[static_cast<std::size_t>(i)];
            least = std::min(least, std::max(0.0, glm::distance(p, q.normal) - clearance_) / q.reach);
        }
        return;
    }
    std::size_t near = index + 1, far = static_cast<std::size_t>(node.right);
    if (glm::distance(p, nodes_[far].centre) < glm::distance(p, nodes_[near].centre)) std::swap(near, far);
    find_nearest(near, p, least);
    find_nearest(far, p, least);
}

void BorderBlend::gather(std::size_t index, const glm::dvec3& p, double& weights, double& total) const {
    const Node& node = nodes_[index];
    const double r = glm::distance(p, node.centre);
    if (r - node.radius >= node.max_reach + clearance_) return;
    if (node.radius < 0.125 * r) {
        const double w = node.weight * weight(r, node.reach + clearance_);
        weights += w;
        total += w * node.difference;
    } else if (node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) {
            const Point& q = points_[static_cast<std::size_t>(i)];
            const double w = q.count * weight(glm::distance(p, q.normal), q.reach + clearance_);
            weights += w;
            total += w * q.difference;
        }
    } else {
        gather(index + 1, p, weights, total);
        gather(static_cast<std::size_t>(node.right), p, weights, total);
    }
}

// Whether a point of the node may be within its reach of any place in a ball.
bool BorderBlend::may_reach(std::size_t index, const glm::dvec3& centre, double radius) const {
    const Node& node = nodes_[index];
    const double beyond = radius + clearance_;
    if (glm::distance(centre, node.centre) - node.radius >= node.max_reach + beyond) return false;
    if (node.right != 0)
        return may_reach(index + 1, centre, radius) || may_reach(static_cast<std::size_t>(node.right), centre, radius);
    const auto begin = points_.begin() + node.first;
    return std::any_of(begin, begin + node.count,
                       [&](const Point& q) { return glm::distance(centre, q.normal) < q.reach + beyond; });
}

void BorderBlend::add(std::span<const glm::dvec3> normals, std::span<double> corrections) const {
    assert(corrections.size() == normals.size());
    constexpr std::size_t few = 32;
    if (nodes_.empty()) return;
    for (std::size_t first = 0; first < normals.size(); first += few) {
        const auto some = normals.subspan(first, std::min(few, normals.size() - first));
        const glm::dvec3 centre = std::accumulate(some.begin(), some.end(), glm::dvec3(0)) / double(some.size());
        double square = 0;
        for (const glm::dvec3& n : some) square = std::max(square, glm::dot(n - centre, n - centre));
        const bool is_number = centre.x + centre.y + centre.z == centre.x + centre.y + centre.z;
        if (is_number && !may_reach(0, centre, std::sqrt(square) * (1 + 1e-9))) continue;
        for (std::size_t i = 0; i < some.size(); ++i) corrections[first + i] += (*this)(some[i]);
    }
}

double BorderBlend::operator()(const glm::dvec3& p) const {
    if (nodes_.empty() || std::isnan(p.x + p.y + p.z)) return 0;
    double least = 1;  // of distance / reach
    find_nearest(0, p, least);
    if (least >= 1) return 0;
    double weights = 0, total = 0;
    gather(0, p, weights, total);
    if (!(weights > 0)) return 0;
    const double s = 1 - least;
    return s * s * (3 - 2 * s) * total / weights;
}

}  // namespace planet
