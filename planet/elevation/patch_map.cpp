#include "planet/elevation/patch_map.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace planet {
namespace {

constexpr int order = 6;
constexpr int max_depth = 8;
constexpr std::size_t max_patches = 8192;  // 7 MB; what is not smooth by then asks the function
constexpr int check_points = 9;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Chebyshev {
    std::array<double, order> node{};
    // Row i: the weight of each node's value in the coefficient of x^i.
    std::array<std::array<double, order>, order> monomial_from_value{};
};

Chebyshev make_chebyshev() {
    Chebyshev c;
    double t[order][order] = {{1}, {0, 1}};  // T_j as powers of x: T_j+1 = 2 x T_j - T_j-1
    for (int j = 2; j < order; ++j)
        for (int i = 0; i < order; ++i) t[j][i] = (i > 0 ? 2 * t[j - 1][i - 1] : 0) - t[j - 2][i];
    for (std::size_t k = 0; k < order; ++k) {
        const double angle = (2.0 * static_cast<double>(k) + 1) * std::numbers::pi / (2 * order);
        c.node[k] = std::cos(angle);
        for (int j = 0; j < order; ++j)
            for (std::size_t i = 0; i < order; ++i)
                c.monomial_from_value[i][k] += (j == 0 ? 1.0 : 2.0) / order * std::cos(j * angle) * t[j][i];
    }
    return c;
}

const Chebyshev& chebyshev() {
    static const Chebyshev table = make_chebyshev();
    return table;
}

glm::dvec3 evaluate(const std::array<glm::dvec3, order * order>& patch, double x, double y) {
    glm::dvec3 sum(0);
    for (std::size_t j = order; j-- > 0;) {
        glm::dvec3 row = patch[j * order + order - 1];
        for (std::size_t i = order - 1; i-- > 0;) row = row * x + patch[j * order + i];
        sum = sum * y + row;
    }
    return sum;
}

}  // namespace

PatchMap::PatchMap(glm::dvec2 low, glm::dvec2 high, Function function, double tolerance)
    : low_(low), high_(high), function_(std::move(function)), tolerance_(tolerance), nodes_(1) {
    build(0, low, high, 0);
}

void PatchMap::build(std::size_t node, glm::dvec2 low, glm::dvec2 high, int depth) {
    if (fit(nodes_[node], low, high, depth)) return;
    const std::size_t first = nodes_.size();
    nodes_[node].children = static_cast<int>(first);
    nodes_.resize(first + 4);
    const glm::dvec2 mid = 0.5 * (low + high);
    for (std::size_t k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, up = (k & 2) != 0;
        build(first + k, {right ? mid.x : low.x, up ? mid.y : low.y}, {right ? high.x : mid.x, up ? high.y : mid.y},
              depth + 1);
    }
}

bool PatchMap::fit(Node& node, glm::dvec2 low, glm::dvec2 high, int depth) {
    const Chebyshev& c = chebyshev();
    const glm::dvec2 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    std::vector<glm::dvec2> local;
    for (std::size_t j = 0; j < order; ++j)
        for (std::size_t i = 0; i < order; ++i) local.emplace_back(c.node[i], c.node[j]);
    for (int j = 0; j < check_points; ++j)
        for (int i = 0; i < check_points; ++i)
            local.emplace_back(2.0 * i / (check_points - 1) - 1, 2.0 * j / (check_points - 1) - 1);
    std::vector<glm::dvec2> at;
    for (const glm::dvec2& p : local) at.push_back(centre + half * p);
    std::vector<glm::dvec3> value(at.size());
    function_(at, value);

    bool any = false;
    for (const glm::dvec3& v : value) any |= !std::isnan(v.x);
    if (!any && depth >= 3) return node.patch = has_none, true;

    Patch patch{};
    std::array<glm::dvec3, order * order> rows{};
    for (std::size_t j = 0; j < order; ++j)
        for (std::size_t i = 0; i < order; ++i)
            for (std::size_t k = 0; k < order; ++k)
                rows[j * order + i] += c.monomial_from_value[i][k] * value[j * order + k];
    for (std::size_t j = 0; j < order; ++j)
        for (std::size_t i = 0; i < order; ++i)
            for (std::size_t k = 0; k < order; ++k)
                patch[j * order + i] += c.monomial_from_value[j][k] * rows[k * order + i];

    bool good = true;  // NaN anywhere makes it false
    for (std::size_t k = order * order; k < local.size(); ++k) {
        const glm::dvec3 d = glm::abs(evaluate(patch, local[k].x, local[k].y) - value[k]);
        good = good && d.x + d.y + d.z <= 0.5 * tolerance_;
    }
    if (good && patches_.size() < max_patches) {
        node.patch = static_cast<int>(patches_.size());
        patches_.push_back(patch);
        return true;
    }
    return depth == max_depth || patches_.size() >= max_patches;
}

glm::dvec3 PatchMap::operator()(glm::dvec2 p) const {
    glm::dvec2 low = low_, high = high_;
    if (!(p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y)) return glm::dvec3(nan);
    const Node* node = nodes_.data();
    while (node->children != 0) {
        const glm::dvec2 mid = 0.5 * (low + high);
        const bool right = p.x >= mid.x, up = p.y >= mid.y;
        (right ? low.x : high.x) = mid.x;
        (up ? low.y : high.y) = mid.y;
        node = &nodes_[static_cast<std::size_t>(node->children + right + 2 * up)];
    }
    if (node->patch == has_none) return glm::dvec3(nan);
    if (node->patch == asks_function) {
        glm::dvec3 value;
        function_({&p, 1}, {&value, 1});
        return value;
    }
    const glm::dvec2 local = (2.0 * p - (low + high)) / (high - low);
    return evaluate(patches_[static_cast<std::size_t>(node->patch)], local.x, local.y);
}

PatchMap::Size PatchMap::size() const {
    Size size;
    for (const Node& n : nodes_)
        if (n.children == 0) (n.patch >= 0 ? size.polynomials : size.exact) += n.patch == has_none ? 0 : 1;
    return size;
}

}  // namespace planet
