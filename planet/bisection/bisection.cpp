#include "planet/bisection/bisection.h"

#include <cassert>
#include <numeric>

#include "planet/bisection/bisection_state.h"

namespace planet {

namespace {

using Index = Bisection::Index;

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

double squared_distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 side = b - a;
    const double s = dot(side, side), along = s > 0 ? std::clamp(dot(p - a, side) / s, 0.0, 1.0) : 0;
    const glm::dvec2 d = p - (a + along * side);
    return dot(d, d);
}

// The leaf among a few that has a side from one vertex to another.
std::optional<Bisection::LeafSide> find_side(const LeafMesh& mesh, std::span<const Index> leaves, Index from,
                                             Index to) {
    for (const Index t : leaves)
        for (int k = 0; k < 3; ++k)
            if (mesh[t].corner[static_cast<std::size_t>(k)] == from &&
                mesh[t].corner[static_cast<std::size_t>((k + 1) % 3)] == to)
                return Bisection::LeafSide{t, k};
    return std::nullopt;
}

}  // namespace

Bisection::Bisection(const PlainMesh& base, BisectionOptions options) : state_(std::make_unique<State>(base, options)) {
    const LeafMesh& mesh = state_->mesh;
    for (Index t = 0; t < mesh.size(); ++t) {
        const auto& c = mesh[t].corner;
        state_->base_angle.push_back(smallest_angle(mesh.judged(c[0]), mesh.judged(c[1]), mesh.judged(c[2])));
    }
}
Bisection::Bisection(Bisection&&) noexcept = default;
Bisection& Bisection::operator=(Bisection&&) noexcept = default;
Bisection::~Bisection() = default;

std::size_t Bisection::triangle_count() const {
    return state_->mesh.size();
}
std::size_t Bisection::vertex_count() const {
    return state_->mesh.vertex_count();
}
std::size_t Bisection::base_vertex_count() const {
    return state_->mesh.base_vertices();
}
std::size_t Bisection::base_triangle_count() const {
    return state_->mesh.base_triangles();
}
std::array<Index, 3> Bisection::corners(Index triangle) const {
    return state_->mesh[triangle].corner;
}
Index Bisection::neighbor(Index triangle, int side) const {
    return state_->mesh[triangle].beyond[static_cast<std::size_t>(side)];
}
glm::dvec3 Bisection::place(Index vertex) const {
    return state_->mesh.place(vertex);
}
TrianglePlaces Bisection::places(Index triangle) const {
    return state_->places(triangle);
}
double Bisection::side_length(Index triangle, int side) const {
    return std::sqrt(state_->mesh[triangle].squared[static_cast<std::size_t>(side)]);
}
bool Bisection::pending(Index triangle) const {
    return state_->mesh[triangle].kind != LeafKind::complete;
}
Index Bisection::base_triangle(Index triangle) const {
    return state_->mesh[triangle].base;
}

std::size_t Bisection::split(Index triangle) {
    if (!state_->mesh.can_halve(state_->mesh[triangle].squared[0])) return 0;
    return state_->split_leaf(triangle);
}

std::size_t Bisection::split_side(LeafSide side) {
    LeafMesh& mesh = state_->mesh;
    const auto k = static_cast<std::size_t>(side.side);
    if (!mesh.can_halve(mesh[side.triangle].squared[k])) return 0;
    const Index from = mesh[side.triangle].corner[k], to = mesh[side.triangle].corner[(k + 1) % 3];
    std::size_t count = 0;
    // Both triangles are split until the side is the longest of each. That of a quarter's may be gone by then.
    for (std::optional<LeafSide> at = side; at;) {
        const Leaf& t = mesh[at->triangle];
        const Index n = t.beyond[static_cast<std::size_t>(at->side)];
        Index next = at->side != 0 ? at->triangle : n != none && !LeafMesh::mutual(t, mesh[n]) ? n : none;
        if (next == none) {
            state_->split_terminal(at->triangle);
            ++count;
            break;
        }
        const auto [name, kind] = std::pair(mesh[next].name, mesh[next].kind);
        while (mesh[next].name == name && mesh[next].kind == kind) {
            state_->split_terminal(mesh.terminal(next));
            ++count;
        }
        const std::array<Index, 1> before = {at->triangle};
        at = find_side(mesh, mesh.changed(), from, to);
        if (!at) at = find_side(mesh, before, from, to);
    }
    state_->count_request(count);
    return count;
}

std::size_t Bisection::step(const std::function<bool(const TrianglePlaces&)>& region) {
    LeafMesh& mesh = state_->mesh;
    struct Now {
        Index leaf, name;
        LeafKind kind;
    };
    std::vector<Now> leaves;
    for (Index t = 0; t < mesh.size(); ++t)
        if (!region || region(places(t))) leaves.push_back({t, mesh[t].name, mesh[t].kind});
    // Longest first, so that a split seldom needs others before it; equal ones in the order of the leaves.
    std::sort(leaves.begin(), leaves.end(), [&](const Now& a, const Now& b) {
        const double x = mesh[a.leaf].squared[0], y = mesh[b.leaf].squared[0];
        return x != y ? x > y : a.leaf < b.leaf;
    });
    std::size_t count = 0;
    for (const Now& now : leaves) {
        const auto unchanged = [&] { return mesh[now.leaf].name == now.name && mesh[now.leaf].kind == now.kind; };
        if (unchanged()) count += split(now.leaf);
        // A quarter that gave way to A'B' still has the middle of its longest side to come: it is that of A'B'.
        const bool gave_way = now.kind == LeafKind::quarter && mesh[now.leaf].name == now.name && !unchanged();
        if (gave_way) count += split(now.leaf);
    }
    return count;
}

std::optional<Bisection::LeafSide> Bisection::nearest_side(glm::dvec2 point) const {
    for (Index t = 0; t < triangle_count(); ++t) {
        const auto [a3, b3, c3] = places(t);
        const std::array<glm::dvec2, 3> p = {glm::dvec2(a3), glm::dvec2(b3), glm::dvec2(c3)};
        const double turn = cross(p[1] - p[0], p[2] - p[0]) < 0 ? -1 : 1;
        LeafSide nearest{t, 0};
        double least = std::numeric_limits<double>::infinity();
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec2 a = p[static_cast<std::size_t>(k)], b = p[static_cast<std::size_t>((k + 1) % 3)];
            inside = inside && turn * cross(b - a, point - a) >= 0;
            const double d = squared_distance(point, a, b);
            if (d < least) {
                least = d;
                nearest.side = k;
            }
        }
        if (inside) return nearest;
    }
    return std::nullopt;
}

PlainMesh Bisection::mesh() const {
    const LeafMesh& leaves = state_->mesh;
    PlainMesh out;
    out.vertices.assign(leaves.places().begin(), leaves.places().end());
    out.attributes.assign(leaves.attributes().begin(), leaves.attributes().end());
    out.attribute_width = leaves.attribute_width();
    out.triangles.reserve(leaves.size());
    for (Index t = 0; t < leaves.size(); ++t) out.triangles.push_back(leaves[t].corner);
    return out;
}

}  // namespace planet
