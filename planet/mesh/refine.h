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
        if (i >> t.depth)
            below(t, i, state);
        else if (test_(t.split[i]))
            children(t, i, state);
        else
            sink_.leaf(t, i, state);
    }

  private:
    // Both children are tested before either is walked: the tests overlap.
    void children(const PlacedTile& t, unsigned i, unsigned state) {
        const unsigned first = 2 * i, second = first + 1;
        const auto [first_state, second_state] = strip_child_states[state];
        if (first >> t.depth) {
            below(t, first, first_state);
            below(t, second, second_state);
            return;
        }
        const bool first_split = test_(t.split[first]), second_split = test_(t.split[second]);
        if (first_split)
            children(t, first, first_state);
        else
            sink_.leaf(t, first, first_state);
        if (second_split)
            children(t, second, second_state);
        else
            sink_.leaf(t, second, second_state);
    }

    // Where the tile ends: a leaf, unless a tile below goes on.
    void below(const PlacedTile& t, unsigned i, unsigned state) {
        const PlacedTile* child = t.child(tiles_, t.position_below(i), test_);
        if (child && test_(child->split[1])) {
            sink_.tile(*child);
            children(*child, 1, state);
            sink_.tile(t);
            return;
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

/// The whole planet as one strip over unique vertices. Keeps its storage from one use to the next.
class StripMesh {
  public:
    /// Replaces the mesh by the leaves that the test asks for. Memory grows with the leaves; for pictures use
    /// segments.h.
    void refine(const TileSource& tiles, const SplitTest& test);

    std::span<const GridPosition> vertices() const { return vertices_.span(); }
    std::span<const std::uint32_t> strip() const { return strip_.indices().span(); }

  private:
    GrowingArray<GridPosition> vertices_;
    StripWriter strip_;
};

/// The same with the list of triangles and their cells: for checks, exports and pictures of the mesh.
TriangleMesh refine_planet(const TileSource& tiles, const SplitTest& test);

}  // namespace planet
