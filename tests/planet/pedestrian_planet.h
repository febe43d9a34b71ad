#pragma once
// Stores of a few rugged places, and what a mesh of the planet must be there, found the pedestrian way.

#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "bumpy_field.h"
#include "planet/bake/bake.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/planet_mesh.h"
#include "planet/store/store_field.h"
#include "planet/store/tile_sides.h"

namespace planet::pedestrian {

using testing::BumpyField;

// Rugged planets with a finer patch in tiles of its own: at a pole, across the antimeridian, in a face, at an E_i on Mars,
// and one in tiles below tiles.
struct Place {
    const char* name;
    glm::dvec3 direction;
    int least_level;
    double angle = 0.004, fine_m = 6000;
    Ellipsoid ellipsoid = wgs84;
};
inline const Place places[] = {{"NorthPole", {0, 0, 1}, 9},
                               {"Antimeridian", {-1, 1e-4, -0.4}, 8},
                               {"Face", {1, 1, 1}, 10},
                               {"MarsAtE1", {1e-3, 1, 1e-3}, 9, 0.004, 6000, mars},
                               {"DeepAtE0", {1, 0.0004, -0.0003}, 9, 2e-4, 1500}};

inline ElevationStore bake_place(const Place& place) {
    BakeOptions options;
    options.ellipsoid = place.ellipsoid;
    options.least_level = place.least_level;
    if (place.ellipsoid == wgs84) options.undulation = testing::bumpy_undulation;
    return bake_in_memory(BumpyField(2e6, {glm::normalize(place.direction), place.angle}, place.fine_m), options);
}

inline const ElevationStore& store_of(std::size_t place) {
    static std::map<std::size_t, ElevationStore> baked;
    auto found = baked.find(place);
    if (found == baked.end()) found = baked.emplace(place, bake_place(places[place])).first;
    return found->second;
}

// Every cell of a store, by the pedestrian way: no tile layouts, no vector arithmetic, nothing pruned.
struct Surface {
    struct Vertex {
        glm::dvec3 normal, place;
    };
    struct Split {
        Vertex vertex;
        double own = 0;       // deviation
        float saturated = 0;  // as stored
        std::array<Vertex, 3> corner;
    };
    std::map<LocationCode, Split> splits;  // of cells that can be split
    std::array<Vertex, 6> corners;         // of the octahedron

    explicit Surface(const ElevationStore& store)
        : placement_{store.metadata().ellipsoid, 1.0}, layers_(store.metadata().layers) {
        for (const LocationCode root : store.tiles()) tiles_.emplace(root, *store.read(root));
        for (int face = 0; face < face_count; ++face) {
            const LocationCode root = LocationCode::face_root(face);
            const Corners c = face_corners(face);
            const Tile& tile = tiles_.at(root);
            visit(root, {at(tile, 0, c.left), at(tile, 1, c.right), at(tile, 2, c.apex)});
        }
    }

    std::size_t triangles() const { return face_count + splits.size(); }
    // Vertices: the two cells of a diamond have the same one.
    std::vector<Vertex> vertices() const {
        std::vector<Vertex> list;
        for (const auto& [cell, split] : splits)
            if (cell == diamond(cell)) list.push_back(split.vertex);
        for (int face = 0; face < 4; ++face) list.push_back(faces_.at(face)[0]);
        list.push_back(faces_.at(0)[2]);
        list.push_back(faces_.at(4)[2]);
        return list;
    }
    std::array<Vertex, 3> face(int f) const { return faces_.at(f); }

  private:
    Vertex at(const Tile& tile, std::size_t v, const glm::dvec3& n) const {
        const GeoidUndulation N = tile.undulation.empty() ? GeoidUndulation{} : tile.undulation[v];
        return {n, placement_.ecef(n, static_cast<double>(tile.height[v]), N)};
    }

    void visit(LocationCode cell, const std::array<Vertex, 3>& corner) {
        if (cell.bisection_level() == 0) faces_[cell.face()] = corner;
        const auto [root, local] = cell_in_tile(cell, layers_);
        const auto tile = tiles_.find(root);
        const bool exists =
            tile != tiles_.end() && local >> tile->second.depth == 0 && tile->second.deviation[local] > 0;
        if (!exists) return;
        const Vertex m =
            at(tile->second, tile_layout().split_vertex[local], split_vertex(corner[0].normal, corner[1].normal));
        splits[cell] = {m, 0, tile->second.deviation[local], corner};
        for (LocationCode above = cell;; above = above.parent()) {
            Split& s = splits.at(above);
            const CellPlane plane(s.corner[0].place, s.corner[1].place, s.corner[2].place);
            s.own = std::max(s.own, std::abs(plane.above(m.place, m.normal)));
            if (above.bisection_level() == 0) break;
        }
        visit(cell.child(0), {corner[0], corner[2], m});
        visit(cell.child(1), {corner[2], corner[1], m});
    }

    Placement placement_;
    TileLayers layers_;
    std::map<LocationCode, Tile> tiles_;
    std::map<int, std::array<Vertex, 3>> faces_;
};

inline const Surface& surface_of(std::size_t place) {
    static std::map<std::size_t, Surface> made;
    auto found = made.find(place);
    if (found == made.end()) found = made.emplace(place, Surface(store_of(place))).first;
    return found->second;
}

// The least set of split cells by its definition: split what is too coarse, mend what does not conform, until nothing
// changes.
inline std::set<LocationCode> least_splits(const Surface& surface, double tolerance) {
    std::set<LocationCode> split;
    const auto require = [&](const auto& self, LocationCode cell) -> void {
        if (!split.insert(cell).second) return;
        self(self, neighbor(cell));
        if (cell.bisection_level() > 0) self(self, cell.parent());
    };
    for (std::size_t before = 1; before != split.size();) {
        before = split.size();
        for (const auto& [cell, s] : surface.splits) {
            const bool leaf = cell.bisection_level() == 0 || split.count(cell.parent()) != 0;
            if (leaf && s.own > tolerance) require(require, cell);
        }
        if (split.empty()) break;
    }
    return split;
}

inline std::vector<LocationCode> sorted(std::vector<LocationCode> cells) {
    std::sort(cells.begin(), cells.end());
    return cells;
}
inline std::vector<LocationCode> leaves_of(const std::set<LocationCode>& split) {
    std::vector<LocationCode> leaves;
    for (int f = 0; f < face_count; ++f)
        if (!split.count(LocationCode::face_root(f))) leaves.push_back(LocationCode::face_root(f));
    for (const LocationCode c : split)
        for (int i = 0; i < 2; ++i)
            if (!split.count(c.child(i))) leaves.push_back(c.child(i));
    return sorted(leaves);
}

// The same figures as measure(), triangle by triangle.
inline DeviationReport measure_slowly(const Surface& surface, const PlanetMesh& made,
                                      std::span<const glm::dvec3> vertices) {
    std::map<LocationCode, std::size_t> triangle;
    for (std::size_t i = 0; i < made.cells.size(); ++i) triangle[made.cells[i]] = i;
    DeviationReport report;
    double squares = 0;
    for (const auto& [cell, split] : surface.splits) {
        const bool counts = cell == diamond(cell);
        report.samples += counts;
        for (LocationCode above = cell;; above = above.parent()) {
            if (const auto found = triangle.find(above); found != triangle.end()) {
                const auto& t = made.mesh.triangles[found->second];
                const CellPlane plane(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
                const double d = std::abs(plane.above(split.vertex.place, split.vertex.normal));
                report.maximum = std::max(report.maximum, d);
                squares += counts ? d * d : 0;
            }
            if (above.bisection_level() == 0) break;
        }
    }
    report.samples += 6;
    report.rms = std::sqrt(squares / static_cast<double>(report.samples));
    return report;
}

}  // namespace planet::pedestrian
