#include "planet/tin/tin_solid.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "planet/tin/delaunay.h"

namespace planet {

namespace {

using Index = std::uint32_t;
using Side = std::array<Index, 2>;

// Sides of one triangle only, as that triangle turns.
std::vector<Side> border_sides(const std::vector<std::array<Index, 3>>& triangles) {
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) sides.push_back({t[k], t[(k + 1) % 3]});
    std::sort(sides.begin(), sides.end());
    std::vector<Side> border;
    for (const Side& side : sides)
        if (!std::binary_search(sides.begin(), sides.end(), Side{side[1], side[0]})) border.push_back(side);
    return border;
}

// Of the triangles at a vertex, those that are linked by sides at it with the first of the list: they are taken out.
std::vector<Index> take_fan(const TinMesh& mesh, Index v, std::vector<Index>& around) {
    std::vector<Index> fan{around.back()};
    around.pop_back();
    const auto shares_side = [&](Index s, Index t) {
        for (const Index a : mesh.triangles[s])
            if (a != v)
                for (const Index b : mesh.triangles[t])
                    if (a == b) return true;
        return false;
    };
    for (std::size_t i = 0; i < fan.size(); ++i)
        std::erase_if(around, [&](Index t) {
            if (!shares_side(fan[i], t)) return false;
            fan.push_back(t);
            return true;
        });
    return fan;
}

void split_touching(TinMesh& mesh) {
    std::map<Index, int> begun;  // border sides, by the vertex where they begin
    for (const Side& side : border_sides(mesh.triangles)) ++begun[side[0]];
    std::erase_if(begun, [](const auto& vertex) { return vertex.second < 2; });
    if (begun.empty()) return;
    std::map<Index, std::vector<Index>> around;
    for (Index t = 0; t < mesh.triangles.size(); ++t)
        for (const Index v : mesh.triangles[t])
            if (begun.contains(v)) around[v].push_back(t);
    for (auto& [v, triangles] : around) {
        take_fan(mesh, v, triangles);  // keeps the vertex
        while (!triangles.empty()) {
            for (const Index t : take_fan(mesh, v, triangles))
                std::replace(mesh.triangles[t].begin(), mesh.triangles[t].end(), v,
                             static_cast<Index>(mesh.vertices.size()));
            mesh.vertices.push_back(mesh.vertices[v]);
            mesh.height.push_back(mesh.height[v]);
        }
    }
}

// The triangles of few sides within the border of a TIN.
TinMesh floor_of(const TinMesh& top, const std::vector<Side>& border, glm::ivec2 last) {
    Delaunay mesh({0, 0}, last);
    std::vector<Delaunay::Index> ends;
    for (const Side& side : border)
        for (const Index v : side) ends.push_back(mesh.insert(top.vertices[v]));
    for (std::size_t i = 0; i < ends.size(); i += 2) {
        const bool possible = mesh.constrain(ends[i], ends[i + 1]);
        assert(possible);
        static_cast<void>(possible);
    }
    std::vector<std::uint8_t> inside(mesh.triangle_slots(), 0);
    std::vector<Delaunay::Index> reached;
    const auto reach = [&](Delaunay::Index t) {
        if (inside[t]) return;
        inside[t] = 1;
        reached.push_back(t);
    };
    for (std::size_t i = 0; i < ends.size(); i += 2) reach(mesh.side_between(ends[i], ends[i + 1]) / 3);
    for (std::size_t i = 0; i < reached.size(); ++i)
        for (Delaunay::Index e = 3 * reached[i]; e < 3 * reached[i] + 3; ++e)
            if (!mesh.constrained(e) && mesh.twin(e) != Delaunay::none) reach(mesh.twin(e) / 3);
    TinMesh floor;
    std::vector<Index> number(mesh.vertex_slots(), Delaunay::none);
    for (const Delaunay::Index t : reached) {
        auto& triangle = floor.triangles.emplace_back(mesh.vertices(t));
        for (Index& v : triangle) {
            if (number[v] == Delaunay::none) {
                number[v] = static_cast<Index>(floor.vertices.size());
                floor.vertices.push_back(mesh.point(v));
                floor.height.push_back(0);
            }
            v = number[v];
        }
    }
    return floor;
}

}  // namespace

TinSolid solid_below(TinMesh mesh, glm::ivec2 last) {
    split_touching(mesh);
    const std::vector<Side> border = border_sides(mesh.triangles);
    TinMesh floor = floor_of(mesh, border, last);
    split_touching(floor);
    // No two sides of the border lie between the same places, so places tell which parts belong together.
    const auto key = [](const TinMesh& m, const Side& side) {
        const glm::ivec2 a = m.vertices[side[0]], b = m.vertices[side[1]];
        return std::array{a.x, a.y, b.x, b.y};
    };
    std::map<std::array<int, 4>, Side> floor_side;
    for (const Side& side : border_sides(floor.triangles)) floor_side[key(floor, side)] = side;

    TinSolid out;
    const auto first = static_cast<Index>(mesh.vertices.size());
    for (const Side& side : border) {
        const auto [a, b] = side;
        const auto [c, d] = floor_side.at(key(mesh, side));
        out.below.push_back({b, a, first + c});
        out.below.push_back({b, first + c, first + d});
    }
    for (const auto& [a, b, c] : floor.triangles) out.below.push_back({first + c, first + b, first + a});
    out.top = std::move(mesh);
    out.floor = std::move(floor.vertices);
    return out;
}

}  // namespace planet
