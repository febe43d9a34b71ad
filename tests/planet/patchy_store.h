#pragma once
// A small store with fine patches at a pole, at E_0 and inside a face, and what says whether a mesh over it is sound.

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>

#include "bumpy_field.h"
#include "planet/bake/bake.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/segments.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet::testing {

class PatchyField final : public ElevationField {
  public:
    VerticalDatum datum() const override { return VerticalDatum::egm96; }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override {
        bumps_.heights(normals, out);
    }
    double spacing(const Cap& cap) const override {
        double finest = 4e5;
        for (const Patch& p : patches) {
            const double apart = std::acos(std::clamp(glm::dot(cap.centre, p.cap.centre), -1.0, 1.0));
            if (apart <= cap.angle + p.cap.angle) finest = std::min(finest, p.spacing_m);
        }
        return finest;
    }
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override { return bumps_.sources(); }

    struct Patch {
        Cap cap;
        double spacing_m;
    };
    static inline const std::array patches = {
        Patch{{glm::normalize(glm::dvec3(1, 0.0004, -0.0003)), 3e-4}, 150},  // at E_0, 3 levels of tiles
        Patch{{glm::dvec3(0, 0, 1), 0.004}, 1500},                           // the pole
        Patch{{glm::normalize(glm::dvec3(1, 1, 1)), 0.05}, 4000}};           // inside N0

  private:
    BumpyField bumps_{4e5, {glm::dvec3(1, 0, 0), 0}, 4e5};
};

inline BakeOptions patchy_options(int first_tile_level = 12) {
    BakeOptions o;
    o.first_tile_level = first_tile_level;
    o.undulation = bumpy_undulation;
    return o;
}

/// The leaves of a mesh, and every vertex by its direction.
struct LeafSink {
    std::vector<LocationCode> leaves;
    std::map<std::array<double, 3>, GridPosition> vertices;
    std::size_t torn = 0;  ///< corners that are elsewhere than another cell has them

    void tile(const PlacedTile&) {}
    void leaf(const PlacedTile& t, unsigned i, unsigned) {
        const LocationCode cell = code_of(t, i);
        leaves.push_back(cell);
        const Corners c = corners(cell);
        const glm::dvec3 normal[3] = {c.left, c.right, c.apex};
        for (std::size_t k = 0; k < 3; ++k) {
            const GridPosition& p = t.position[tile_layout().corners[i][k]];
            const glm::dvec3& n = normal[k];
            torn += vertices.try_emplace({n.x, n.y, n.z}, p).first->second != p;
        }
    }
};

/// "" if the leaves tile the planet, no side has a vertex in its middle, and cells agree where their corners are.
inline std::string crack_in(const TileSource& tiles, const SplitTest& test) {
    LeafSink sink;
    Walk walk(tiles, test, sink);
    for (int face = 0; face < face_count; ++face) walk.cell(*tiles.tile(LocationCode::face_root(face)), 1, 0);
    if (sink.torn != 0) return std::to_string(sink.torn) + " corners are torn";
    std::set<LocationCode> split;
    for (const LocationCode leaf : sink.leaves)
        for (LocationCode c = leaf; c.bisection_level() > 0 && split.insert(c.parent()).second;) c = c.parent();
    for (const LocationCode cell : split)
        if (!split.contains(neighbor(cell))) return "a crack at " + to_string(cell);
    return "";
}

/// FNV-1a over a mesh: equal for equal leaves at equal places.
inline std::uint64_t hash_of(const TileSource& tiles, const SplitTest& test) {
    const TriangleMesh mesh = refine_planet(tiles, test);
    std::uint64_t h = 0xcbf29ce484222325u;
    const auto add = [&h](const void* data, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i) h = (h ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001b3u;
    };
    add(mesh.vertices.data(), mesh.vertices.size() * sizeof(GridPosition));
    add(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
    add(mesh.cells.data(), mesh.cells.size() * sizeof(LocationCode));
    return h;
}

/// A store of PatchyField, baked once for each level at which tiles below the faces may begin.
inline const ElevationStore& patchy_store(int first_tile_level = 12) {
    static std::map<int, ElevationStore> baked;
    const auto found = baked.find(first_tile_level);
    if (found != baked.end()) return found->second;
    return baked.emplace(first_tile_level, bake_in_memory(PatchyField(), patchy_options(first_tile_level)))
        .first->second;
}

inline SegmentView view_from(const glm::dvec3& towards, double height, double K) {
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, glm::normalize(towards), {height}), K};
    view.culling.eye = view.test.eye;
    return view;
}

/// Looking at a place from above it, 40 degrees wide.
inline SegmentView narrow(SegmentView view) {
    const glm::dvec3 down = -glm::normalize(view.test.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(down, glm::dvec3(0.3, -0.2, 0.9))), up = glm::cross(right, down);
    const double s = std::sin(20 * degrees), c = std::cos(20 * degrees);
    view.culling.inward = {s * down + c * right, s * down - c * right, s * down + c * up, s * down - c * up};
    view.culling.occluder_radius = 6.33e6;
    return view;
}

/// Over every patch, from far to near.
inline std::vector<SegmentView> patchy_views() {
    std::vector<SegmentView> list;
    for (const PatchyField::Patch& p : PatchyField::patches)
        for (const double height : {2e7, 1e6, 1e5, 1e4})
            for (const bool whole : {true, false}) {
                const SegmentView view = view_from(p.cap.centre + glm::dvec3(1e-4, 2e-4, -1e-4), height, 400);
                list.push_back(whole ? view : narrow(view));
            }
    return list;
}

}  // namespace planet::testing
