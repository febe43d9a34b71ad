#include "planet/exporters/conforming.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include "planet/exporters/text_words.h"

namespace planet {
namespace {

using Index = std::uint32_t;
using Places = std::span<const glm::dvec3>;

std::string vertex_text(const SurfaceMesh& mesh, Index v) {
    const glm::dvec3& p = mesh.vertices[v];
    return "vertex " + std::to_string(v) + " (" + text_of(p.x) + ", " + text_of(p.y) + ", " + text_of(p.z) + ")";
}

std::string side_text(const SurfaceMesh& mesh, Index a, Index b) {
    return "the side from " + vertex_text(mesh, a) + " to " + vertex_text(mesh, b);
}

bool before(const glm::dvec3& p, const glm::dvec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
}

std::optional<std::string> shape_fault(const SurfaceMesh& mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const std::string name = "triangle " + std::to_string(t);
        if (a == b || b == c || c == a)
            return name + " has two corners at " + vertex_text(mesh, a == b || a == c ? a : b);
        const glm::dvec3 u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
        if (!(glm::length(glm::cross(u, v)) > 1e-15 * std::max(glm::dot(u, u), glm::dot(v, v))))
            return name + " has no area: " + vertex_text(mesh, a) + ", " + vertex_text(mesh, b) + ", " +
                   vertex_text(mesh, c);
    }
    return std::nullopt;
}

// A side of a triangle, from its lesser to its greater vertex.
struct Side {
    Index low, high;
    bool forward;  ///< its triangle runs from low to high
    auto ends() const { return std::tie(low, high); }
};

std::vector<Side> sides_of(const SurfaceMesh& mesh) {
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = t[k], b = t[(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.ends() < t.ends(); });
    return sides;
}

// Leaves sides of one triangle, in their order.
std::optional<std::string> sharing_fault(const SurfaceMesh& mesh, std::vector<Side>& sides) {
    std::size_t border = 0;
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].ends() == sides[i].ends()) ++end;
        const Side side = sides[i];
        if (end - i > 2) return side_text(mesh, side.low, side.high) + " has " + std::to_string(end - i) + " triangles";
        if (end - i == 2 && side.forward == sides[i + 1].forward)
            return side_text(mesh, side.low, side.high) + " has two triangles that turn unlike each other";
        if (end - i == 1) sides[border++] = side;
        i = end;
    }
    sides.resize(border);
    return std::nullopt;
}

std::optional<std::string> seam_fault(const SurfaceMesh& mesh, const std::vector<Side>& border) {
    std::vector<std::pair<Index, Index>> sides;  // from the end that comes first in space
    for (const Side& s : border) {
        const bool swapped = before(mesh.vertices[s.high], mesh.vertices[s.low]);
        sides.emplace_back(swapped ? s.high : s.low, swapped ? s.low : s.high);
    }
    const auto key = [&](const std::pair<Index, Index>& s) {
        const glm::dvec3 &p = mesh.vertices[s.first], &q = mesh.vertices[s.second];
        return std::make_tuple(p.x, p.y, p.z, q.x, q.y, q.z);
    };
    std::sort(sides.begin(), sides.end(), [&](const auto& s, const auto& t) { return key(s) < key(t); });
    for (std::size_t i = 0; i + 1 < sides.size(); ++i)
        if (key(sides[i]) == key(sides[i + 1]))
            return side_text(mesh, sides[i].first, sides[i].second) + " and that from " +
                   vertex_text(mesh, sides[i + 1].first) + " to " + vertex_text(mesh, sides[i + 1].second) +
                   " lie at the same place";
    return std::nullopt;
}

// Points in boxes in boxes, so that those near a line are found without looking at the others.
class PointTree {
  public:
    PointTree(Places places, std::vector<Index> points) : places_(places), points_(std::move(points)) {
        if (!points_.empty()) build(0, points_.size());
    }

    /// The first point found for which `test` holds, of those within `reach` of the line's box in every box on the way.
    template <class Test>
    std::optional<Index> find(const glm::dvec3& a, const glm::dvec3& b, double reach, const Test& test) const {
        if (points_.empty()) return std::nullopt;
        std::vector<std::size_t> left{0};
        while (!left.empty()) {
            const Node& node = nodes_[left.back()];
            const std::size_t number = left.back();
            left.pop_back();
            if (!meets(node, a, b, reach)) continue;
            if (node.right == 0) {
                for (std::size_t i = node.begin; i < node.end; ++i)
                    if (test(points_[i])) return points_[i];
                continue;
            }
            left.push_back(node.right);
            left.push_back(number + 1);
        }
        return std::nullopt;
    }

  private:
    struct Node {
        glm::dvec3 low, high;
        std::size_t begin, end, right = 0;  ///< the left child is the next node
    };

    void build(std::size_t begin, std::size_t end) {
        constexpr std::size_t few = 8;
        Node node{places_[points_[begin]], places_[points_[begin]], begin, end};
        for (std::size_t i = begin; i < end; ++i) {
            node.low = glm::min(node.low, places_[points_[i]]);
            node.high = glm::max(node.high, places_[points_[i]]);
        }
        const std::size_t number = nodes_.size();
        nodes_.push_back(node);
        if (end - begin <= few) return;
        const glm::dvec3 size = node.high - node.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [&](Index p, Index q) { return places_[p][axis] < places_[q][axis]; });
        build(begin, middle);
        nodes_[number].right = nodes_.size();
        build(middle, end);
    }

    // The slab test, of a line that is `reach` thick.
    static bool meets(const Node& node, const glm::dvec3& a, const glm::dvec3& b, double reach) {
        double from = 0, to = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double low = node.low[axis] - reach, high = node.high[axis] + reach, d = b[axis] - a[axis];
            if (d == 0) {
                if (a[axis] < low || a[axis] > high) return false;
                continue;
            }
            const double s = (low - a[axis]) / d, t = (high - a[axis]) / d;
            from = std::max(from, std::min(s, t));
            to = std::min(to, std::max(s, t));
        }
        return from <= to;
    }

    Places places_;
    std::vector<Index> points_;
    std::vector<Node> nodes_;
};

double extent_of(const SurfaceMesh& mesh) {
    glm::dvec3 low = mesh.vertices[0], high = low;
    for (const glm::dvec3& v : mesh.vertices) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

std::optional<std::string> junction_fault(const SurfaceMesh& mesh, const std::vector<Side>& border) {
    std::vector<Index> vertices;
    for (const Side& s : border) {
        vertices.push_back(s.low);
        vertices.push_back(s.high);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const PointTree tree(mesh.vertices, std::move(vertices));
    const double rounding = 1.2e-7 * extent_of(mesh);
    for (const Side& s : border) {
        const glm::dvec3 &a = mesh.vertices[s.low], &b = mesh.vertices[s.high], u = b - a;
        const double uu = glm::dot(u, u), reach = std::min(rounding, 1e-3 * std::sqrt(uu));
        const auto within = [&](Index v) {
            const glm::dvec3 w = mesh.vertices[v] - a;
            const double share = glm::dot(w, u) / uu;
            // At the ends it would be another corner there, not one within the side.
            if (!(share > 1e-3 && share < 1 - 1e-3)) return false;
            return glm::length(w - share * u) <= reach;
        };
        if (const auto v = tree.find(a, b, reach, within))
            return side_text(mesh, s.low, s.high) + " has " + vertex_text(mesh, *v) + " within it: a T-junction";
    }
    return std::nullopt;
}

template <class Attribute>
void keep(std::vector<Attribute>& attribute, const std::vector<Index>& kept) {
    if (attribute.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) attribute[i] = attribute[kept[i]];
    attribute.resize(kept.size());
}

}  // namespace

std::optional<std::string> conforming_fault(const SurfaceMesh& mesh) {
    if (auto fault = shape_fault(mesh)) return fault;
    std::vector<Side> border = sides_of(mesh);
    if (auto fault = sharing_fault(mesh, border)) return fault;
    if (border.empty()) return std::nullopt;
    if (auto fault = seam_fault(mesh, border)) return fault;
    return junction_fault(mesh, border);
}

std::size_t weld(SurfaceMesh& mesh, MeshLooks& looks) {
    const auto& places = mesh.vertices;
    std::vector<Index> sorted(places.size()), number(places.size());
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) {
        return before(places[a], places[b]) || (!before(places[b], places[a]) && a < b);
    });
    for (std::size_t i = 0; i < sorted.size(); ++i)  // the first at each place
        number[sorted[i]] = i > 0 && places[sorted[i]] == places[sorted[i - 1]] ? number[sorted[i - 1]] : sorted[i];
    std::vector<Index> kept;
    for (Index v = 0; v < number.size(); ++v) {
        if (number[v] == v) {
            number[v] = static_cast<Index>(kept.size());  // from here on of the welded mesh
            kept.push_back(v);
        } else {
            number[v] = number[number[v]];
        }
    }
    const std::size_t gone = places.size() - kept.size();
    for (auto& t : mesh.triangles)
        for (Index& v : t) v = number[v];
    keep(mesh.vertices, kept);
    keep(looks.normals, kept);
    keep(looks.uv, kept);
    keep(looks.colors, kept);
    mesh.level.clear();
    mesh.strip.clear();
    return gone;
}

}  // namespace planet
