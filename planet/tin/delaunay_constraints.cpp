// Constrained sides of a Delaunay triangulation.

#include <algorithm>

#include "planet/tin/delaunay.h"

namespace planet {

namespace {

// Calls what with every half-edge that begins at v, until it returns false.
template <class What>
void around(const Delaunay& mesh, Delaunay::Index v, What&& what) {
    const Delaunay::Index start = mesh.out(v);
    Delaunay::Index e = start;
    do {
        if (!what(e)) return;
        e = mesh.twin(Delaunay::previous(e));
    } while (e != Delaunay::none && e != start);
    if (e == start) return;
    while ((e = mesh.twin(e == Delaunay::none ? start : e)) != Delaunay::none) {
        e = Delaunay::next(e);
        if (!what(e)) return;
    }
}

// What a straight line from a towards b meets first: a vertex, after the sides on the way there (half-edges from right
// to left of it).
Delaunay::Index march(const Delaunay& mesh, Delaunay::Index a, Delaunay::Index b, std::vector<Delaunay::Index>& sides) {
    const glm::ivec2 from = mesh.point(a), to = mesh.point(b);
    Delaunay::Index reached = Delaunay::none, e = Delaunay::none;
    sides.clear();
    const auto ahead = [&](Delaunay::Index v) {
        const glm::ivec2 p = mesh.point(v);
        const glm::i64vec2 u = to - from, w = p - from;
        return orientation(from, to, p) == 0 && u.x * w.x + u.y * w.y > 0;
    };
    around(mesh, a, [&](Delaunay::Index out) {
        const Delaunay::Index across = Delaunay::next(out);
        const Delaunay::Index right = mesh.origin(across), left = mesh.origin(Delaunay::next(across));
        if (ahead(right)) reached = right;
        if (ahead(left)) reached = left;
        if (orientation(from, to, mesh.point(right)) < 0 && orientation(from, to, mesh.point(left)) > 0) e = across;
        return reached == Delaunay::none && e == Delaunay::none;
    });
    while (reached == Delaunay::none) {
        sides.push_back(e);
        const Delaunay::Index f = mesh.twin(e), apex = mesh.origin(Delaunay::previous(f));
        const std::int64_t turn = orientation(from, to, mesh.point(apex));
        if (turn == 0)
            reached = apex;
        else
            e = turn > 0 ? Delaunay::next(f) : Delaunay::previous(f);
    }
    return reached;
}

}  // namespace

Delaunay::Index Delaunay::side_between(Index a, Index b) const {
    Index found = none;
    around(*this, a, [&](Index e) {
        if (origin_[next(e)] == b) found = e;
        return found == none;
    });
    return found;
}

void Delaunay::set_constrained(Index e) {
    constrained_[e] = 1;
    if (twin_[e] != none) constrained_[twin_[e]] = 1;
}

// a, b: ends of the side; c left and d right of it become the ends.
//
//         c                c
//       / | \            /   \                                                         .
//      a-e->b    ->     a--t--b      t = (a, d, c), u = (d, b, c)
//       \ | /            \   /
//         d                d
void Delaunay::flip(Index e) {
    const Index f = twin_[e], t = e / 3, u = f / 3;
    const std::array<Index, 4> inner{next(f), previous(f), next(e), previous(e)};  // a-d, d-b, b-c, c-a
    std::array<Boundary, 4> outer;
    for (std::size_t k = 0; k < 4; ++k) outer[k] = {twin_[inner[k]], constrained(inner[k])};
    const Index a = origin_[e], b = origin_[f], c = origin_[inner[3]], d = origin_[inner[1]];
    set_triangle(t, a, d, c);
    set_triangle(u, d, b, c);
    const std::array<Index, 4> now{3 * t, 3 * u, 3 * u + 1, 3 * t + 2};
    for (std::size_t k = 0; k < 4; ++k) {
        link(now[k], outer[k].outer);
        if (has_constraints()) constrained_[now[k]] = outer[k].constrained;
    }
    link(3 * t + 1, 3 * u + 2);
    if (has_constraints()) constrained_[3 * t + 1] = constrained_[3 * u + 2] = 0;
    changed_.push_back(t);
    changed_.push_back(u);
}

void Delaunay::make_delaunay(std::vector<Index>& ends) {
    while (!ends.empty()) {
        const Index b = ends.back(), a = ends[ends.size() - 2];
        ends.resize(ends.size() - 2);
        const Index e = side_between(a, b);
        if (e == none || twin_[e] == none || constrained(e)) continue;
        const Index c = origin_[previous(e)], d = origin_[previous(twin_[e])];
        if (!in_circle(point_[a], point_[b], point_[c], point_[d])) continue;
        flip(e);
        for (const auto& side : {std::array{a, d}, std::array{d, b}, std::array{b, c}, std::array{c, a}})
            ends.insert(ends.end(), side.begin(), side.end());
    }
}

// After Sloan, "A fast algorithm for generating constrained Delaunay triangulations": sides in the way are flipped
// wherever the two triangles make a convex quadrilateral, until none is; then the flipped ones are made Delaunay again.
void Delaunay::force_side(Index from, Index to, std::span<const Index> sides) {
    std::vector<std::array<Index, 2>> crossing;
    for (const Index e : sides) crossing.push_back({origin_[e], origin_[next(e)]});
    std::vector<Index> flipped;
    for (std::size_t i = 0; i < crossing.size(); ++i) {
        const auto [right, left] = crossing[i];
        const Index e = side_between(right, left), c = origin_[previous(e)], d = origin_[previous(twin_[e])];
        if (orientation(point_[d], point_[left], point_[c]) <= 0 ||
            orientation(point_[c], point_[right], point_[d]) <= 0) {
            crossing.push_back({right, left});
            continue;
        }
        flip(e);
        const std::int64_t turn_c = orientation(point_[from], point_[to], point_[c]),
                           turn_d = orientation(point_[from], point_[to], point_[d]);
        if ((turn_c > 0 && turn_d < 0) || (turn_c < 0 && turn_d > 0))
            crossing.push_back(turn_c < 0 ? std::array{c, d} : std::array{d, c});
        else
            flipped.insert(flipped.end(), {c, d});
    }
    const Index e = side_between(from, to);
    set_constrained(e != none ? e : side_between(to, from));
    make_delaunay(flipped);
}

bool Delaunay::constrain(Index a, Index b) {
    std::vector<Index> sides;
    for (Index from = a; from != b;) {
        const Index reached = march(*this, from, b, sides);
        for (const Index e : sides)
            if (constrained(e)) {
                crossed_ = {origin_[e], origin_[next(e)]};
                return false;
            }
        from = reached;
    }
    if (!has_constraints()) constrained_.assign(origin_.size(), 0);
    changed_.clear();
    for (Index from = a; from != b;) {
        const Index reached = march(*this, from, b, sides);
        force_side(from, reached, sides);
        from = reached;
    }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    return true;
}

void Delaunay::hold(Index e) {
    if (!has_constraints()) constrained_.assign(origin_.size(), 0);
    set_constrained(e);
}

void Delaunay::release(Index e) {
    constrained_[e] = 0;
    if (twin_[e] != none) constrained_[twin_[e]] = 0;
    changed_.clear();
    std::vector<Index> ends{origin_[e], origin_[next(e)]};
    make_delaunay(ends);
}

}  // namespace planet
