#include "planet/elevation/border_blend.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "planet/lanes.h"

namespace planet {
namespace {

constexpr int leaf_points = 8;
constexpr double closest = 1e-12;  // chord: 6 micrometres on Earth

using Mask = WholeLanes;  // -1 in the lanes that are meant

// At least 0, and monotonic in r.
Lanes weight(const Lanes& r, double reach) {
    const Lanes w = (reach - r) / (reach * larger(r, Lanes{} + closest));
    return r >= reach ? Lanes{} : w * w;
}

}  // namespace

struct BorderBlend::Places {
    Lanes x, y, z;
    Lanes least = Lanes{} + 1;            // of distance / reach
    Lanes nearest = Lanes{} + 1, file{};  // the same, below 0 within the clearance, and that point's
    Mask within{};                        // reach of a point
    Lanes weights{}, total{};

    Lanes from(const glm::dvec3& q) const {
        const Lanes dx = q.x - x, dy = q.y - y, dz = q.z - z;
        return square_root(dx * dx + dy * dy + dz * dz);
    }
};

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
        const auto points = static_cast<double>(p->count);
        node.centre += points * p->normal;
        node.difference += points * p->difference;
        node.reach += points * p->reach;
        node.weight += points;
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

void BorderBlend::find_nearest(std::size_t index, Places& p) const {
    const Node& node = nodes_[index];
    if (!any(p.from(node.centre) - node.radius - clearance_ < p.least * node.max_reach)) return;
    if (node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) {
            const Point& q = points_[static_cast<std::size_t>(i)];
            const Lanes ratio = (p.from(q.normal) - clearance_) / q.reach;
            p.least = smaller(larger(ratio, Lanes{}), p.least);
            // Of equally near ones the first file's, so that the order of the visits does not matter.
            const Lanes file = Lanes{} + static_cast<double>(q.file);
            p.file = (ratio < p.nearest) | ((ratio == p.nearest) & (file < p.file)) ? file : p.file;
            p.nearest = smaller(ratio, p.nearest);
        }
        return;
    }
    std::size_t near = index + 1, far = static_cast<std::size_t>(node.right);
    if (p.from(nodes_[far].centre)[0] < p.from(nodes_[near].centre)[0]) std::swap(near, far);
    find_nearest(near, p);
    find_nearest(far, p);
}

// Each lane takes part in what it would visit alone, in that order.
void BorderBlend::gather(std::size_t index, Places& p) const {
    const Node& node = nodes_[index];
    const Mask outer = p.within;
    const Lanes r = p.from(node.centre);
    const Mask visits = outer & ~(r - node.radius >= node.max_reach + clearance_);
    if (!any(visits)) return;
    const auto take = [&p](const Mask& who, const Lanes& w, double difference) {
        p.weights += who ? w : Lanes{};
        p.total += who ? w * difference : Lanes{};
    };
    const Mask as_one = visits & (node.radius < 0.125 * r);
    if (any(as_one)) take(as_one, node.weight * weight(r, node.reach + clearance_), node.difference);
    p.within = visits & ~as_one;
    if (any(p.within) && node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) {
            const Point& q = points_[static_cast<std::size_t>(i)];
            take(p.within, static_cast<double>(q.count) * weight(p.from(q.normal), q.reach + clearance_), q.difference);
        }
    } else if (any(p.within)) {
        gather(index + 1, p);
        gather(static_cast<std::size_t>(node.right), p);
    }
    p.within = outer;
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

void BorderBlend::add(std::span<const glm::dvec3> normals, std::span<double> corrections,
                      std::span<BorderShare> shares) const {
    assert(corrections.size() == normals.size() && (shares.empty() || shares.size() == normals.size()));
    constexpr std::size_t few = 32;
    if (nodes_.empty()) return;
    for (std::size_t first = 0; first < normals.size(); first += few) {
        const auto some = normals.subspan(first, std::min(few, normals.size() - first));
        const glm::dvec3 centre = std::accumulate(some.begin(), some.end(), glm::dvec3(0)) / double(some.size());
        double square = 0;
        for (const glm::dvec3& n : some) square = std::max(square, glm::dot(n - centre, n - centre));
        const bool is_number = centre.x + centre.y + centre.z == centre.x + centre.y + centre.z;
        if (is_number && !may_reach(0, centre, std::sqrt(square) * (1 + 1e-9))) continue;
        for (std::size_t i = 0; i < some.size(); i += lane_count) {
            const std::size_t n = std::min(lane_count, some.size() - i);
            add_some(some.subspan(i, n), corrections.subspan(first + i, n),
                     shares.empty() ? shares : shares.subspan(first + i, n));
        }
    }
}

// A NaN is within no reach.
void BorderBlend::add_some(std::span<const glm::dvec3> normals, std::span<double> corrections,
                           std::span<BorderShare> shares) const {
    const auto axis = [&](int k) {
        return gather_lanes([&](std::size_t w) { return normals[std::min(w, normals.size() - 1)][k]; });
    };
    Places p{.x = axis(0), .y = axis(1), .z = axis(2)};
    find_nearest(0, p);
    p.within = p.least < 1;
    if (!any(p.within)) return;
    gather(0, p);
    const Lanes s = 1 - p.least;
    const Lanes correction = p.weights > 0 ? s * s * (3 - 2 * s) * p.total / p.weights : Lanes{};
    for (std::size_t w = 0; w < normals.size(); ++w) corrections[w] += correction[w];
    for (std::size_t w = 0; w < shares.size(); ++w)
        if (p.weights[w] > 0) shares[w] = {s[w] * s[w] * (3 - 2 * s[w]), static_cast<std::uint32_t>(p.file[w])};
}

double BorderBlend::operator()(const glm::dvec3& normal) const {
    double correction = 0;
    add({&normal, 1}, {&correction, 1});
    return correction;
}

}  // namespace planet
