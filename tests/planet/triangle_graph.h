#pragma once
// The hierarchy of triangles as a graph made from coordinates alone: no codes, no neighbour arithmetic. Slow, and what
// the closures of planet/quadtree are tested against. Besides, a test for T-junctions on coordinates.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <glm/glm.hpp>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "planet/quadtree/topology.h"
#include "planet/quadtree/triangulation.h"

namespace planet::testing {

using LatticePoint = glm::i64vec3;
using LatticeTriangle = std::array<LatticePoint, 3>;  ///< left, right, apex

struct PointHash {
    std::size_t operator()(const LatticePoint& p) const {
        const auto u = [](std::int64_t x) { return static_cast<std::uint64_t>(x); };
        return (u(p.x) * 0x9e3779b97f4a7c15u ^ (u(p.y) + 0x632be59bd9b4e019u) * 0xff51afd7ed558ccdu) +
               u(p.z) * 0xc4ceb9fe1a85ec53u;
    }
};

/// Steps along a root's legs so that the corners of `levels` bisections are integers.
inline std::int64_t lattice_size(int levels) {
    return std::int64_t{1} << ((levels + 1) / 2);
}

/// In the order of root numbers. The patches lie in z = 0, y up.
inline std::vector<LatticeTriangle> root_triangles(const PatchGrid& grid, std::int64_t size) {
    std::vector<LatticeTriangle> roots;
    for (int row = 0; row < grid.rows(); ++row)
        for (int column = 0; column < grid.columns(); ++column) {
            const LatticePoint sw(column * size, row * size, 0), se = sw + LatticePoint(size, 0, 0),
                                                                 nw = sw + LatticePoint(0, size, 0),
                                                                 ne = se + LatticePoint(0, size, 0);
            roots.push_back({sw, ne, nw});
            roots.push_back({ne, sw, se});
        }
    return roots;
}
/// The flat octahedron |x| + |y| + |z| = size.
inline std::vector<LatticeTriangle> root_triangles(const OctahedronTopology&, std::int64_t size) {
    const LatticePoint e[] = {{size, 0, 0}, {0, size, 0}, {-size, 0, 0}, {0, -size, 0}};
    const LatticePoint north(0, 0, size), south(0, 0, -size);
    std::vector<LatticeTriangle> roots;
    for (int i = 0; i < 4; ++i) roots.push_back({e[i], e[(i + 1) % 4], north});
    for (int i = 0; i < 4; ++i) roots.push_back({e[(i + 1) % 4], e[i], south});
    return roots;
}

inline bool is_border(const OctahedronTopology&, std::int64_t, const LatticePoint&, const LatticePoint&) {
    return false;
}
inline bool is_border(const PatchGrid& grid, std::int64_t size, const LatticePoint& a, const LatticePoint& b) {
    return (a.x == b.x && (a.x == 0 || a.x == grid.columns() * size)) ||
           (a.y == b.y && (a.y == 0 || a.y == grid.rows() * size));
}

inline std::array<LatticeTriangle, 2> halves(const LatticeTriangle& t) {
    const LatticePoint sum = t[0] + t[1], m = sum / std::int64_t{2};
    return {LatticeTriangle{t[0], t[2], m}, LatticeTriangle{t[2], t[1], m}};
}

class TriangleGraph {
  public:
    struct Triangle {
        LatticeTriangle corners;
        int parent = -1;
        std::array<int, 2> children{-1, -1};
        int split_vertex = -1;
    };
    struct Vertex {
        LatticePoint at;
        std::vector<int> triangles;            ///< those that it splits
        std::vector<int> parents, dependants;  ///< vertices without which it cannot be, and the other way round
        int level = 0;                         ///< bisection level of its triangles
    };

    /// Everything to `levels` bisections, and no vertex present but the corners of the roots, which are not counted.
    template <Topology Topo>
    TriangleGraph(const Topo& topology, int levels) : size_(lattice_size(levels)) {
        for (const LatticeTriangle& t : root_triangles(topology, size_)) triangles_.push_back({t});
        roots_ = static_cast<int>(triangles_.size());
        std::size_t begin = 0;
        for (int level = 0; level < levels; ++level) {
            const std::size_t end = triangles_.size();
            for (std::size_t i = begin; i < end; ++i) bisect(static_cast<int>(i), level);
            begin = end;
        }
        for (std::size_t v = 0; v < vertices_.size(); ++v)
            for (const int t : vertices_[v].triangles) {
                // A triangle is there if the vertex is that bisected its parent: its apex. Corners of roots always are.
                const auto apex = vertex_at_.find(triangles_[static_cast<std::size_t>(t)].corners[2]);
                if (apex == vertex_at_.end()) continue;
                vertices_[v].parents.push_back(apex->second);
                vertices_[static_cast<std::size_t>(apex->second)].dependants.push_back(static_cast<int>(v));
            }
        present_.assign(vertices_.size(), 0);
    }

    std::int64_t size() const { return size_; }
    const std::vector<Vertex>& vertices() const { return vertices_; }
    const Triangle& triangle(int t) const { return triangles_[static_cast<std::size_t>(t)]; }
    int split_vertex(int t) const { return triangle(t).split_vertex; }
    bool is_present(int v) const { return present_[static_cast<std::size_t>(v)] != 0; }
    void set_all(bool present) { present_.assign(vertices_.size(), present); }

    /// The triangle that a path leads to. @param root number, in the order of root_triangles()
    int triangle_at(int root, std::uint64_t path, int level) const {
        int t = root;
        for (int i = level - 1; i >= 0; --i) t = triangle(t).children[path >> i & 1];
        return t;
    }

    /// Adds a vertex and what it cannot be without. @return the vertices added
    std::vector<int> refine(int v) {
        std::vector<int> added;
        reach(v, &Vertex::parents, false, added);
        for (const int a : added) present_[static_cast<std::size_t>(a)] = 1;
        return added;
    }
    /// Takes out a vertex and what cannot be without it. @return the maximal triangles that merge, sorted
    std::vector<int> remove(int v) {
        std::vector<int> removed, merged;
        if (!is_present(v)) return merged;
        reach(v, &Vertex::dependants, true, removed);
        for (const int r : removed) present_[static_cast<std::size_t>(r)] = 0;
        for (const int r : removed)
            for (const int t : vertices_[static_cast<std::size_t>(r)].triangles)
                if (triangle(t).parent < 0 || is_present(split_vertex(triangle(t).parent))) merged.push_back(t);
        std::sort(merged.begin(), merged.end());
        return merged;
    }
    /// A vertex is there, and nothing depends on it.
    bool can_go(int v) const {
        bool alone = is_present(v);
        for (const int d : vertices_[static_cast<std::size_t>(v)].dependants) alone = alone && !is_present(d);
        return alone;
    }

  private:
    void bisect(int t, int level) {
        const LatticeTriangle corners = triangle(t).corners;
        const auto parts = halves(corners);
        const auto [found, added] = vertex_at_.try_emplace(parts[0][2], static_cast<int>(vertices_.size()));
        if (added) vertices_.push_back({parts[0][2], {}, {}, {}, level});
        vertices_[static_cast<std::size_t>(found->second)].triangles.push_back(t);
        triangles_[static_cast<std::size_t>(t)].split_vertex = found->second;
        for (const std::size_t i : {0u, 1u}) {
            triangles_[static_cast<std::size_t>(t)].children[i] = static_cast<int>(triangles_.size());
            triangles_.push_back({parts[i], t});
        }
    }
    // All that can be reached from v over vertices that are present or not, itself included.
    void reach(int v, std::vector<int> Vertex::*next, bool present, std::vector<int>& reached) {
        ++stamp_;
        seen_.resize(vertices_.size());
        const auto visit = [&](int w) {
            if (is_present(w) != present || seen_[static_cast<std::size_t>(w)] == stamp_) return;
            seen_[static_cast<std::size_t>(w)] = stamp_;
            reached.push_back(w);
        };
        visit(v);
        for (std::size_t i = 0; i < reached.size(); ++i)
            for (const int w : vertices_[static_cast<std::size_t>(reached[i])].*next) visit(w);
    }

    std::int64_t size_;
    int roots_ = 0;
    std::vector<Triangle> triangles_;
    std::vector<Vertex> vertices_;
    std::unordered_map<LatticePoint, int, PointHash> vertex_at_;
    std::vector<char> present_;
    std::vector<unsigned> seen_;
    unsigned stamp_ = 0;
};

/// The graph's triangle of a code.
template <Topology Topo>
int graph_triangle(const TriangleGraph& graph, const Topo& topology, CellCode cell) {
    const int level = bisection_level_of(cell, topology.root_bits());
    const CellCode root = (cell >> level) & ((CellCode{1} << topology.root_bits()) - 1);
    return graph.triangle_at(static_cast<int>(root), cell & ((CellCode{1} << level) - 1), level);
}

/// The leaves of a triangulation as triangles of the lattice for `levels` bisections.
template <Topology Topo, class Set>
std::vector<LatticeTriangle> leaf_triangles(const Triangulation<Topo, Set>& t) {
    std::vector<LatticeTriangle> leaves;
    const auto walk = [&](const auto& self, CellCode cell, const LatticeTriangle& corners) -> void {
        if (!t.is_split(cell)) {
            leaves.push_back(corners);
            return;
        }
        const auto parts = halves(corners);
        self(self, cell << 1, parts[0]);
        self(self, cell << 1 | 1, parts[1]);
    };
    const auto roots = root_triangles(t.topology(), lattice_size(t.levels()));
    for (std::size_t i = 0; i < roots.size(); ++i) walk(walk, CellCode{1} << t.topology().root_bits() | i, roots[i]);
    return leaves;
}

/// Every side belongs to two triangles, or to one at a border, and the areas add up. @return what is wrong; empty:
/// nothing, and so there is no T-junction
template <Topology Topo, class Set>
std::string conformity_fault(const Triangulation<Topo, Set>& t) {
    struct SideHash {
        std::size_t operator()(const std::pair<LatticePoint, LatticePoint>& s) const {
            return PointHash{}(s.first) * 31 + PointHash{}(s.second);
        }
    };
    const auto area = [](const LatticeTriangle& c) {  // twice the area, times a factor of the plane, exact in 64 bits
        const auto minor = [](std::int64_t a, std::int64_t b, std::int64_t c2, std::int64_t d) {
            return static_cast<double>(a) * static_cast<double>(d) - static_cast<double>(b) * static_cast<double>(c2);
        };
        const LatticePoint u = c[1] - c[0], v = c[2] - c[0];
        return std::abs(minor(u.x, u.y, v.x, v.y)) + std::abs(minor(u.y, u.z, v.y, v.z)) +
               std::abs(minor(u.z, u.x, v.z, v.x));
    };
    const std::int64_t size = lattice_size(t.levels());
    std::unordered_map<std::pair<LatticePoint, LatticePoint>, int, SideHash> sides;
    double covered = 0, whole = 0;
    for (const LatticeTriangle& c : root_triangles(t.topology(), size)) whole += area(c);
    for (const LatticeTriangle& c : leaf_triangles(t)) {
        covered += area(c);
        for (const std::size_t i : {0u, 1u, 2u}) {
            LatticePoint a = c[i], b = c[(i + 1) % 3];
            if (std::tie(a.x, a.y, a.z) > std::tie(b.x, b.y, b.z)) std::swap(a, b);
            ++sides[{a, b}];
        }
    }
    if (std::abs(covered - whole) > 1e-9 * whole) return "the areas do not add up";
    for (const auto& [side, count] : sides)
        if (count != (is_border(t.topology(), size, side.first, side.second) ? 1 : 2)) {
            const auto text = [](const LatticePoint& p) {
                return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
            };
            return "side " + text(side.first) + " to " + text(side.second) + " has " + std::to_string(count);
        }
    return {};
}

/// Every cell split.
template <class Set, Topology Topo>
Triangulation<Topo, Set> full_mesh(const Topo& topology, int levels) {
    Triangulation<Topo, Set> t(topology, levels);
    if (levels > 0)
        for (int rank = 0; rank < topology.root_count(); ++rank) t.split_cells().fill(topology.root(rank));
    return t;
}

}  // namespace planet::testing
