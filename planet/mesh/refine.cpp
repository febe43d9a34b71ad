#include "planet/mesh/refine.h"

namespace planet {

namespace {

/// Turns leaves into one strip over unique vertices.
struct StripSink {
    GrowingArray<GridPosition>& vertices;
    StripWriter& strip;
    const TileLayout& layout = tile_layout();

    // A tile's own cells have at most tile_cells leaves, and a leaf adds at most one vertex.
    void tile(const PlacedTile&) {
        strip.reserve(tile_cells + 1);
        vertices.reserve_more(tile_cells + 3);
    }

    std::uint32_t add(const PlacedTile& t, std::uint16_t vertex) {
        vertices.push(t.position[vertex]);
        return static_cast<std::uint32_t>(vertices.size() - 1);
    }

    std::uint32_t leaf(const PlacedTile& t, unsigned i, unsigned state) {
        return strip.leaf(state, [&](std::size_t corner) { return add(t, layout.corners[i][corner]); });
    }
};

struct ListSink : StripSink {
    TriangleMesh& mesh;

    void leaf(const PlacedTile& t, unsigned i, unsigned state) {
        const bool first = !strip.begun();
        const std::uint32_t l = first ? 0 : strip.gate_left(), r = first ? 1 : strip.gate_right();
        const std::uint32_t w = StripSink::leaf(t, i, state);
        mesh.triangles.push_back({l, r, w});
        mesh.cells.push_back(code_of(t, i));
    }
};

template <class Sink>
void walk_planet(const TileSource& tiles, const SplitTest& test, Sink& sink) {
    Walk walk(tiles, test, sink);
    for (int rank = 0; rank < face_count; ++rank) {
        const int face = face_at_loop_rank(rank);
        const PlacedTile* root = tiles.tile(LocationCode::face_root(face));
        assert(root != nullptr);
        sink.tile(*root);
        walk.cell(*root, 1, strip_state_of_face(face));
    }
}

}  // namespace

void StripMesh::refine(const TileSource& tiles, const SplitTest& test) {
    vertices_.clear();
    strip_.clear();
    StripSink sink{.vertices = vertices_, .strip = strip_};
    walk_planet(tiles, test, sink);
}

TriangleMesh refine_planet(const TileSource& tiles, const SplitTest& test) {
    TriangleMesh mesh;
    GrowingArray<GridPosition> vertices;
    StripWriter strip;
    ListSink sink{{.vertices = vertices, .strip = strip}, mesh};
    walk_planet(tiles, test, sink);
    mesh.vertices.assign(vertices.span().begin(), vertices.span().end());
    mesh.strip.assign(strip.indices().span().begin(), strip.indices().span().end());
    return mesh;
}

}  // namespace planet
