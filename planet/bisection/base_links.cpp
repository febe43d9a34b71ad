// Which triangles of a mesh share sides, and whether they may.

#include <string>

#include "planet/bisection/leaf_mesh.h"
#include "planet/error.h"

namespace planet {

namespace {

using Index = std::uint32_t;

// A side of a triangle by its lesser corner: where it is kept; the greater corner; half-edge 3 t + k.
struct SideEntry {
    Index greater, half_edge;
};

[[noreturn]] void refuse(const std::string& what, const std::string& accepted) {
    throw Error(Fault::bad_data, "the mesh", what, accepted);
}

std::string side_text(Index a, Index b) {
    return "the side from vertex " + std::to_string(a) + " to vertex " + std::to_string(b);
}

void check_counts(const PlainMesh& base) {
    if (base.triangles.empty()) refuse("no triangles", "at least one");
    if (base.triangles.size() > std::size_t{1} << 28)
        refuse(std::to_string(base.triangles.size()) + " triangles", "at most 268435456");
    if (base.attributes.size() != base.attribute_width * base.vertices.size())
        refuse("attributes of other than " + std::to_string(base.vertices.size()) + " vertices", "as many of each");
    for (std::size_t v = 0; v < base.vertices.size(); ++v)
        for (int i = 0; i < 3; ++i)
            if (!(std::abs(base.vertices[v][i]) <= 1e30))
                refuse("vertex " + std::to_string(v) + " is at no place", "coordinates from -1e30 to 1e30");
    for (std::size_t t = 0; t < base.triangles.size(); ++t) {
        const auto& c = base.triangles[t];
        for (const Index v : c)
            if (v >= base.vertices.size())
                refuse("triangle " + std::to_string(t) + " has vertex " + std::to_string(v),
                       "0 to " + std::to_string(base.vertices.size() - 1));
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
            refuse("triangle " + std::to_string(t) + " has two corners at one vertex", "three vertices");
    }
}

// All sides in one array, those with one lesser corner next to each other; first[v] is where those of v begin.
std::vector<SideEntry> sides_by_lesser_corner(const PlainMesh& base, std::vector<Index>& first) {
    first.assign(base.vertices.size() + 1, 0);
    const auto& triangles = base.triangles;
    for (const auto& c : triangles)
        for (std::size_t k = 0; k < 3; ++k) ++first[std::min(c[k], c[(k + 1) % 3]) + 1];
    for (std::size_t v = 0; v + 1 < first.size(); ++v) first[v + 1] += first[v];
    std::vector<SideEntry> entries(3 * triangles.size());
    std::vector<Index> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            entries[next[std::min(a, b)]++] = {std::max(a, b), static_cast<Index>(3 * t + k)};
        }
    return entries;
}

}  // namespace

std::vector<std::array<Index, 3>> base_links(const PlainMesh& base) {
    check_counts(base);
    std::vector<Index> first;
    std::vector<SideEntry> entries = sides_by_lesser_corner(base, first);
    std::vector<std::array<Index, 3>> beyond(base.triangles.size(), {LeafMesh::none, LeafMesh::none, LeafMesh::none});
    const auto begins_at = [&](Index half_edge) { return base.triangles[half_edge / 3][half_edge % 3]; };
    for (Index v = 0; v + 1 < first.size(); ++v) {
        const std::span sides(entries.data() + first[v], first[v + 1] - first[v]);
        std::sort(sides.begin(), sides.end(), [](const SideEntry& a, const SideEntry& b) {
            return a.greater != b.greater ? a.greater < b.greater : a.half_edge < b.half_edge;
        });
        for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
            if (sides[i].greater != sides[i + 1].greater) continue;
            const Index e = sides[i].half_edge, f = sides[i + 1].half_edge;
            if (i + 2 < sides.size() && sides[i + 2].greater == sides[i].greater)
                refuse(side_text(v, sides[i].greater) + " has more than two triangles", "one or two");
            if (begins_at(e) == begins_at(f))
                refuse(side_text(v, sides[i].greater) + " has two triangles that turn unlike each other",
                       "one orientation");
            beyond[e / 3][e % 3] = f / 3;
            beyond[f / 3][f % 3] = e / 3;
            ++i;
        }
    }
    for (std::size_t t = 0; t < beyond.size(); ++t) {
        const auto& n = beyond[t];
        if ((n[0] != LeafMesh::none && (n[0] == n[1] || n[0] == n[2])) || (n[1] != LeafMesh::none && n[1] == n[2]))
            refuse("triangle " + std::to_string(t) + " has a second one at the same three vertices", "one");
    }
    return beyond;
}

}  // namespace planet
