#include "planet/mesh/refine.h"

namespace planet {

namespace {

struct MeshSink {
    TriangleMesh& mesh;
    StripWriter strip;
    std::size_t vertex_count = 0;
    bool with_triangles;
    bool begun = false;

    void tile(const PlacedTile&) { room(); }

    // A tile's own cells have at most tile_cells leaves.
    void room() {
        strip.reserve(2 * tile_cells);
        if (mesh.vertices.size() < vertex_count + 2 * tile_cells)
            mesh.vertices.resize(2 * (vertex_count + 2 * tile_cells));
    }

    std::uint32_t add(const PlacedTile& t, std::uint16_t vertex) {
        mesh.vertices[vertex_count] = t.position[vertex];
        return static_cast<std::uint32_t>(vertex_count++);
    }

    void leaf(const PlacedTile& t, unsigned i, unsigned state) {
        const auto& corner = tile_layout_.corners[i];
        if (!begun) {
            const auto [l, r] = strip_first_gate(state);
            const std::uint32_t left = add(t, corner[l]), right = add(t, corner[r]);
            strip.begin(left, right);
            begun = true;
        }
        const std::uint32_t l = strip.gate_left(), r = strip.gate_right();
        const StripStep step = strip_steps[state];
        const std::uint32_t w = strip.step(step, [&] { return add(t, corner[step.corner]); });
        if (with_triangles) {
            mesh.triangles.push_back({l, r, w});
            mesh.cells.push_back(code_of(t, i));
        }
    }

    const TileLayout& tile_layout_ = tile_layout();
};

}  // namespace

TriangleMesh refine_planet(const TileSource& tiles, const SplitTest& test, bool with_triangles) {
    TriangleMesh mesh;
    MeshSink sink{.mesh = mesh, .strip = {}, .with_triangles = with_triangles};
    Walk walk(tiles, test, sink);
    for (int rank = 0; rank < face_count; ++rank) {
        const int face = face_at_loop_rank(rank);
        const PlacedTile* root = tiles.tile(LocationCode::face_root(face));
        assert(root != nullptr);
        sink.tile(*root);
        walk.cell(*root, 1, strip_state_of_face(face));
    }
    mesh.vertices.resize(sink.vertex_count);
    mesh.strip.assign(sink.strip.data(), sink.strip.data() + sink.strip.size());
    return mesh;
}

}  // namespace planet
