// Segments that morph: as the eye moves and K changes, no point of the drawn surface jumps, whatever splits and merges.

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

#include "pedestrian_planet.h"
#include "planet/frames.h"
#include "planet/mesh/morph.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/segments.h"
#include "planet/streaming/store_tiles.h"

namespace planet {
namespace {

using pedestrian::places;
using pedestrian::store_of;
using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;

Key key(const GridPosition& g) {
    return {g.x, g.y, g.z, g.low};
}

/// A vertex of a mesh, and the ends of the side that it splits; corners of faces have none.
struct Vertex {
    glm::dvec3 place;
    MorphVertex morph{};
    bool splits_side = false;
    Key ends[2]{};

    double reach(double K) const {
        return static_cast<double>(morph.radius) + K * static_cast<double>(morph.deviation);
    }
    glm::dvec3 offset() const { return {morph.x, morph.y, morph.z}; }
};
using Mesh = std::map<Key, Vertex>;

void note_sides(const TileSource& tiles, const SplitTest& test, const PlacedTile& t, unsigned i, Mesh& mesh) {
    if (i >> t.depth) {
        const PlacedTile* below = t.child(tiles, t.position_below(i));
        if (below) note_sides(tiles, test, *below, 1, mesh);
        return;
    }
    if (!test(t.split[i])) return;
    const TileLayout& layout = tile_layout();
    const std::size_t v = layout.split_vertex[i];
    Vertex& vertex = mesh.at(key(t.position[v]));
    vertex.splits_side = true;
    for (std::size_t k = 0; k < 2; ++k) vertex.ends[k] = key(t.position[layout.ends[v][k]]);
    note_sides(tiles, test, t, 2 * i, mesh);
    note_sides(tiles, test, t, 2 * i + 1, mesh);
}

Mesh mesh_of(const Segments& segments, const TileSource& tiles, const SegmentView& view) {
    Mesh mesh;
    for (const Segment& s : segments.segments())
        for (std::uint32_t v = s.first_vertex; v < s.first_vertex + s.vertex_count; ++v) {
            const GridPosition& g = segments.vertices()[v].position;
            mesh[key(g)] = {.place = ecef_from_grid(g), .morph = segments.morphs()[v]};
        }
    for (int face = 0; face < face_count; ++face)
        note_sides(tiles, view.test, *tiles.tile(LocationCode::face_root(face)), 1, mesh);
    return mesh;
}

/// How the vertex shader weighs a vertex.
double arrival(const Vertex& v, double distance, double K) {
    return arrival_fraction(distance, v.reach(K), static_cast<double>(v.morph.width));
}
/// A weight that seems as good: slow, over a fifth of the distance, but ends may still be on their way.
double leisurely(const Vertex& v, double distance, double K) {
    return morph_fraction(v.reach(K) / distance, 1.25);
}

/// The drawn surface over a vertex of the mesh or of a finer one: there it is the middle of the side.
template <class Weight>
glm::dvec3 drawn(const Mesh& mesh, const Mesh& other, const Key& at, const SplitTest& test, Weight&& weight) {
    if (const auto found = mesh.find(at); found != mesh.end()) {
        const Vertex& v = found->second;
        if (!v.splits_side) return v.place;
        return v.place + (1 - weight(v, glm::distance(test.eye, v.place), test.K)) * v.offset();
    }
    const Vertex& v = other.at(at);
    return (drawn(mesh, other, v.ends[0], test, weight) + drawn(mesh, other, v.ends[1], test, weight)) / 2.0;
}

/// The two meshes of a step, and how far it may move their points.
struct Step {
    const Mesh &before, &after;
    SplitTest from, to;

    /// As morph.h says; where a vertex is in one mesh only, it has been on its side for a while.
    double bound(const Key& at) const {
        const auto in_before = before.find(at);
        const Vertex& v = in_before != before.end() ? in_before->second : after.at(at);
        if (!v.splits_side) return 0;
        const double own =
            1.5 * glm::length(v.offset()) / static_cast<double>(v.morph.width) *
            (glm::distance(from.eye, to.eye) + std::abs(to.K - from.K) * static_cast<double>(v.morph.deviation));
        if (in_before != before.end() && after.contains(at)) return own;
        return std::max(own, (bound(v.ends[0]) + bound(v.ends[1])) / 2);
    }
    template <class Weight>
    double moved(const Key& at, Weight&& weight) const {
        return glm::distance(drawn(before, after, at, from, weight), drawn(after, before, at, to, weight));
    }
};

/// A vertex that would come while an end of its side were on its way, had vertices a fifth of the distance to arrive; any
/// one if there are none.
const Vertex& hasty_vertex(const Mesh& mesh, double K, std::mt19937_64& random) {
    std::vector<const Vertex*> hasty, all;
    for (const auto& [at, v] : mesh) {
        if (!v.splits_side) continue;
        all.push_back(&v);
        for (const Key& end : v.ends) {
            const Vertex& e = mesh.at(end);
            if (e.splits_side && 1.2 * v.reach(K) > e.reach(K)) hasty.push_back(&v);
        }
    }
    const auto& list = hasty.empty() ? all : hasty;
    return *list[random() % list.size()];
}

class SegmentsMorph : public ::testing::TestWithParam<std::size_t> {
  protected:
    static constexpr double float_rounding_m = 0.05;

    TileCache cache{store_of(GetParam())};
    glm::dvec3 centre = glm::normalize(places[GetParam()].direction),
               side = glm::normalize(glm::cross(centre, glm::dvec3(0.1, 0.7, -0.4)));
    double a = places[GetParam()].ellipsoid.a;
};
INSTANTIATE_TEST_SUITE_P(, SegmentsMorph, ::testing::Range<std::size_t>(0, std::size(places)),
                         [](const auto& p) { return places[p.param].name; });

// Where a vertex comes, the ends of its side have arrived, wherever the eye is: by their numbers alone, over all vertices.
TEST_P(SegmentsMorph, VerticesComeOnSidesWhoseEndsHaveArrived) {
    for (const double exaggeration : {1.0, 0.3, 5.0}) {
        const StoreTiles tiles(cache, {places[GetParam()].ellipsoid, exaggeration});
        SegmentView view;
        view.radius_m = places[GetParam()].ellipsoid.mean_radius();
        view.morph = true;
        view.test = {centre * (a + 10000), 2000};
        Segments segments;
        segments.build(tiles, view);
        const Mesh mesh = mesh_of(segments, tiles, view);
        std::size_t sides = 0;
        for (const auto& [at, v] : mesh) {
            if (!v.splits_side) continue;
            for (const Key& end : v.ends) {
                const Vertex& e = mesh.at(end);
                if (!e.splits_side) continue;
                // Both distances are rounded by less than half a metre in the split test.
                for (const double K : {0.0, 100.0, view.test.K})
                    ASSERT_GE(e.reach(K) - v.reach(K),
                              glm::distance(e.place, v.place) + static_cast<double>(e.morph.width) + 2 * 0.44)
                        << "exaggeration " << exaggeration;
                ++sides;
            }
        }
        EXPECT_GT(sides, 3000u);
    }
}

// Places along a flight, with more or less budget, and at each a step of two metres over the threshold of some vertex, by
// the eye or by as much of K: no point of the surface moves by more than the step is worth.
TEST_P(SegmentsMorph, NothingJumpsAlongAFlightWithABudget) {
    const StoreTiles tiles(cache, {places[GetParam()].ellipsoid, 1});
    SegmentView view;
    view.radius_m = places[GetParam()].ellipsoid.mean_radius();
    view.morph = true;
    std::mt19937_64 random(7);
    Segments segments;
    std::size_t came = 0, went = 0, jumps = 0;
    for (int f = 0; f < 24; ++f) {
        view.test = {centre * (a + 15000 * std::pow(60.0, (23 - f) / 23.0)) + side * (2000.0 * f),
                     f % 3 == 0 ? 4000.0 : 900.0};
        segments.update(tiles, view);
        const Vertex v = hasty_vertex(mesh_of(segments, tiles, view), view.test.K, random);
        const double spare = v.reach(view.test.K) - glm::distance(v.place, view.test.eye);
        const glm::dvec3 away = glm::normalize(view.test.eye - v.place);
        view.test.eye += away * (spare - 1);
        SplitTest beyond = view.test;
        if (f % 4 == 0)
            beyond.K -= 2 / static_cast<double>(v.morph.deviation);
        else
            beyond.eye += away * 2.0;
        SplitTest from = view.test, to = beyond;
        if (f % 2 == 1) std::swap(from, to);

        view.test = from;
        segments.update(tiles, view);
        const Mesh before = mesh_of(segments, tiles, view);
        view.test = to;
        segments.update(tiles, view);
        const Mesh after = mesh_of(segments, tiles, view);
        const Step step{before, after, from, to};
        for (const Mesh* mesh : {&before, &after})
            for (const auto& [at, vertex] : *mesh) {
                const double most = 1.0001 * step.bound(at) + float_rounding_m;
                ASSERT_LE(step.moved(at, arrival), most) << "place " << f;
                jumps += step.moved(at, leisurely) > most;
                went += mesh == &before && !after.contains(at);
                came += mesh == &after && !before.contains(at);
            }
    }
    EXPECT_GE(came, 12u);
    EXPECT_GE(went, 12u);
    EXPECT_GT(jumps, 0u) << "the bound would hold for any weight";
}

}  // namespace
}  // namespace planet
