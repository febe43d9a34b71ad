#include "planet/tin/tin_mending.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include "planet/tin/delaunay.h"

namespace planet {

namespace {

using Index = Delaunay::Index;
using Side = std::array<glm::ivec2, 2>;

// How many rings of triangles around one may change with it. Where a cavity would reach beyond, it ends there.
constexpr int rings = 2;

bool before(glm::ivec2 p, glm::ivec2 q) {
    return std::tie(p.x, p.y) < std::tie(q.x, q.y);
}
bool side_before(const Side& s, const Side& t) {
    return s[0] == t[0] ? before(s[1], t[1]) : before(s[0], t[0]);
}
Side side_between(glm::ivec2 p, glm::ivec2 q) {
    return before(p, q) ? Side{p, q} : Side{q, p};
}

// Sides that stay, in order.
class HeldSides {
  public:
    explicit HeldSides(std::vector<Side>& sides) : sides_(sides) {
        for (Side& side : sides_) side = side_between(side[0], side[1]);
        std::ranges::sort(sides_, side_before);
    }
    bool empty() const { return sides_.empty(); }
    bool hold(const Side& side) const { return std::ranges::binary_search(sides_, side, side_before); }
    void divide(const Side& side, glm::ivec2 p) {
        const auto at = std::ranges::lower_bound(sides_, side, side_before);
        if (at == sides_.end() || *at != side) return;
        sides_.erase(at);
        for (const glm::ivec2 end : side) {
            const Side half = side_between(end, p);
            sides_.insert(std::ranges::lower_bound(sides_, half, side_before), half);
        }
    }

  private:
    std::vector<Side>& sides_;
};

// Ascending: those with a corner of the given ones, those with a corner of these, and so on.
std::vector<Index> triangles_around(const TinMesh& mesh, std::vector<Index> triangles) {
    std::vector<bool> met(mesh.vertices.size());
    for (int ring = 0; ring < rings; ++ring) {
        for (const Index t : triangles)
            for (const Index v : mesh.triangles[t]) met[v] = true;
        triangles.clear();
        for (Index t = 0; t < mesh.triangles.size(); ++t) {
            const auto [a, b, c] = mesh.triangles[t];
            if (met[a] || met[b] || met[c]) triangles.push_back(t);
        }
    }
    return triangles;
}

template <class T>
Index place_of(const std::vector<T>& ascending, T value) {
    return static_cast<Index>(std::ranges::lower_bound(ascending, value) - ascending.begin());
}

// Some triangles of a mesh, linked.
class Neighbourhood {
  public:
    Neighbourhood(const TinMesh& mesh, const std::vector<Index>& triangles, HeldSides& held)
        : triangle_(triangles_around(mesh, triangles)),
          vertex_(corners_of(mesh, triangle_)),
          linked_(link(mesh)),
          held_(held),
          has_changed_(triangle_.size()) {
        if (held_.empty()) return;
        for (Index e = 0; e < 3 * linked_.triangle_slots(); ++e)
            if (held_.hold(side(e))) linked_.hold(e);
    }

    // @return false, and nothing is done, if the triangle has changed
    bool insert(glm::ivec2 sample, Index triangle) {
        const Index t = place_of(triangle_, triangle);
        if (has_changed_[t]) return false;
        const Delaunay::Location at = linked_.locate_in(sample, t);
        assert(at.vertex == Delaunay::none);
        if (at.side != Delaunay::none && linked_.constrained(at.side)) held_.divide(side(at.side), sample);
        linked_.insert(sample, at);
        has_changed_.resize(linked_.triangle_slots());
        for (const Index c : linked_.changed()) has_changed_[c] = true;
        return true;
    }

    // @param changed gets the triangles that have, in any order
    void put_back(TinMesh& mesh, const HeightGrid& grid, std::vector<Index>& changed) {
        while (vertex_.size() < linked_.vertex_slots()) {
            const glm::ivec2 sample = linked_.point(static_cast<Index>(vertex_.size()));
            vertex_.push_back(static_cast<Index>(mesh.vertices.size()));
            mesh.vertices.push_back(sample);
            mesh.height.push_back(grid.at(sample));
        }
        for (Index t = 0; t < linked_.triangle_slots(); ++t) {
            if (!has_changed_[t]) continue;
            if (t >= triangle_.size()) {
                triangle_.push_back(static_cast<Index>(mesh.triangles.size()));
                mesh.triangles.emplace_back();
            }
            changed.push_back(triangle_[t]);
            const auto corners = linked_.vertices(t);
            for (std::size_t k = 0; k < 3; ++k) mesh.triangles[triangle_[t]][k] = vertex_[corners[k]];
        }
    }

  private:
    static std::vector<Index> corners_of(const TinMesh& mesh, const std::vector<Index>& triangles) {
        std::vector<Index> vertices;
        vertices.reserve(3 * triangles.size());
        for (const Index t : triangles)
            vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
        std::ranges::sort(vertices);
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        return vertices;
    }

    Delaunay link(const TinMesh& mesh) const {
        std::vector<glm::ivec2> points;
        points.reserve(vertex_.size());
        for (const Index v : vertex_) points.push_back(mesh.vertices[v]);
        std::vector<std::array<Index, 3>> triangles;
        triangles.reserve(triangle_.size());
        for (const Index t : triangle_) {
            const auto [a, b, c] = mesh.triangles[t];
            triangles.push_back({place_of(vertex_, a), place_of(vertex_, b), place_of(vertex_, c)});
        }
        return {std::move(points), triangles};
    }

    Side side(Index e) const {
        return side_between(linked_.point(linked_.origin(e)), linked_.point(linked_.origin(Delaunay::next(e))));
    }

    std::vector<Index> triangle_, vertex_;  ///< of the mesh, by those that are linked
    Delaunay linked_;
    HeldSides& held_;
    std::vector<bool> has_changed_;  ///< by triangle that is linked
};

// How many samples are put in before others are looked at: so many that their neighbourhoods take little memory beside
// the mesh, and all triangles are not gone through too often.
std::size_t samples_at_a_time(const TinMesh& mesh) {
    return std::max<std::size_t>(1024, mesh.triangles.size() / 256);
}

}  // namespace

MendedTin mend(TinMesh& mesh, const HeightGrid& grid, std::span<const FarTriangle> due) {
    MendedTin mended;
    HeldSides held(mesh.held_sides);
    mesh.triangles.reserve(mesh.triangles.size() + 2 * due.size());
    mesh.vertices.reserve(mesh.vertices.size() + due.size());
    mesh.height.reserve(mesh.height.size() + due.size());
    std::vector<bool> has_changed(mesh.triangles.size());
    const std::size_t step = samples_at_a_time(mesh);
    for (; !due.empty(); due = due.subspan(std::min(step, due.size()))) {
        const auto now = due.first(std::min(step, due.size()));
        std::vector<Index> triangles;
        for (const FarTriangle& far : now) triangles.push_back(far.triangle);
        Neighbourhood around(mesh, triangles, held);
        for (const FarTriangle& far : now)
            if (!has_changed[far.triangle]) mended.inserted += around.insert(far.sample, far.triangle);
        const std::size_t known = mended.changed.size();
        around.put_back(mesh, grid, mended.changed);
        has_changed.resize(mesh.triangles.size());
        for (std::size_t i = known; i < mended.changed.size(); ++i) has_changed[mended.changed[i]] = true;
    }
    std::ranges::sort(mended.changed);
    mended.changed.erase(std::unique(mended.changed.begin(), mended.changed.end()), mended.changed.end());
    return mended;
}

}  // namespace planet
