#pragma once
// The walk: from a split test to the leaves of a conforming triangulation, in Sierpinski order.

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/strip.h"
#include "planet/mesh/triangle_mesh.h"
#include "planet/mesh/view.h"

namespace planet {

/// Walks the leaves below one cell in Sierpinski order. `sink.tile(t)` is called when the walk enters a tile, before
/// any of its leaves; `sink.leaf(t, i, state)` for the leaf with local index i of tile t. With a nested test the leaves
/// of all cells of the planet are one conforming triangulation.
template <class Test, class Sink>
class Walk {
  public:
    Walk(const TileSource& tiles, const Test& test, Sink& sink) : tiles_(tiles), test_(test), sink_(sink) {}

    void cell(const PlacedTile& t, unsigned i, unsigned state) {
        if (i >> t.depth) {
            below(t, i, state);
        } else if (test_(t.split[i])) {
            cell(t, 2 * i, strip_child_states[state][0]);
            cell(t, 2 * i + 1, strip_child_states[state][1]);
        } else {
            sink_.leaf(t, i, state);
        }
    }

  private:
    void below(const PlacedTile& t, unsigned i, unsigned state) {
        if (t.depth == tile_levels && t.child_exists[i - tile_cells]) {
            const LocationCode root(t.root.bits() << tile_levels | (i - tile_cells));
            if (const PlacedTile* child = tiles_.tile(root); child && test_(child->split[1])) {
                sink_.tile(*child);
                cell(*child, 1, state);
                sink_.tile(t);
                return;
            }
        }
        sink_.leaf(t, i, state);
    }

    const TileSource& tiles_;
    const Test& test_;
    Sink& sink_;
};

/// The code of local cell i of a tile.
inline LocationCode code_of(const PlacedTile& t, unsigned i) {
    const int level = static_cast<int>(std::bit_width(i)) - 1;
    return LocationCode(t.root.bits() << level | (i ^ 1u << level));
}

/// The whole planet as one closed mesh: every leaf, unique vertices, one strip. Memory grows with the leaves; use
/// segments (segments.h) for pictures.
/// @param with_triangles fill triangles and cells beside the vertices and the strip
TriangleMesh refine_planet(const TileSource& tiles, const SplitTest& test, bool with_triangles = true);

}  // namespace planet
