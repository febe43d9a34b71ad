#pragma once
// A segment's strip and vertices, from its root.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/growing_array.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/segment_tree.h"

namespace planet {

/// 24 bytes, as the GPU takes them.
struct SegmentVertex {
    GridPosition position;
    std::uint16_t u, v;  ///< 32768 = 1, in the frame of the segment's patch
    float height;        ///< metres above the store's datum, not exaggerated
};
static_assert(sizeof(SegmentVertex) == 24);

/// Where a vertex comes from and when, see Arrival in morph.h: 24 bytes, as the GPU takes them.
struct MorphVertex {
    /// From the vertex to the middle of the side that it splits, ecef, metres, rounded once. 0 for corners of faces.
    float x, y, z;
    /// Of its diamond, metres, saturated and exaggerated as in its split test: the vertex comes where |eye - vertex| =
    /// radius + K deviation.
    float deviation, radius;
    /// Metres, above 0: the vertex has arrived where the eye is that much nearer. Corners of faces: 0.
    float width;
};
static_assert(sizeof(MorphVertex) == 24);

/// A cell, found. A cell that is a leaf where its tile ends is in the tile above.
struct PlacedCell {
    const PlacedTile* tile;
    unsigned local;

    LocationCode code() const { return code_of(*tile, local); }
};

/// A segment, but for the arrays.
struct BuiltSegment {
    PlacedCell root{};
    LocationCode cell{}, patch{};
    Sphere sphere{};  ///< holds the segment
    std::uint32_t leaves = 0, vertices = 0, indices = 0;
    std::uint32_t first_vertex = 0, first_index = 0, first_leaf = 0;  ///< in the arrays of the builder
    bool detailed = false, damaged = false;
    double slack = 0;  ///< metres: while the eye moves by less, the same cells are the segment's leaves
    double ratio_max = 0, deviation_max = 0;  ///< see Segments
    /// Metres: what is not split for want of a tile is at least that far. Infinite if nothing is.
    double least_reach = 0;
};

/// Finds and builds segments, into storage of its own that it keeps from one use to the next.
///
/// One walk: leaves are put on a stack; where two halves of a cell hold more than segment_leaves together, each becomes a
/// segment, if it is not already several.
class SegmentBuilder {
  public:
    enum class Purpose { draw, count };

    /// Forgets what was built. @param purpose if it is to count, segments have but a cell, a sphere and leaves
    void begin(const TileSource& tiles, const SegmentView& view, Purpose purpose = Purpose::draw);

    /// Appends the segments below a cell, in Sierpinski order. @param half the patch's half that holds it
    void build(const PlacedCell& cell, LocationCode half, std::vector<BuiltSegment>& built);

    std::span<const SegmentVertex> vertices() const { return vertices_.span(); }
    std::span<const MorphVertex> morphs() const { return morphs_.span(); }
    std::span<const std::uint32_t> indices() const { return strip_.indices().span(); }
    std::span<const std::uint8_t> leaf_levels() const { return leaf_levels_.span(); }

  private:
    struct Leaf {
        const PlacedTile* tile;
        std::uint16_t local;
        std::uint8_t level;
        bool damaged;
    };
    /// A comparison "|eye - m| < reach" of the walk.
    struct Compared {
        double distance2, reach;
    };
    /// Leaves found and not yet in a segment, and what is to be certified of them: |eye - m| < radius + K |deviation| must
    /// go on to fail, or to hold where a tile is wanting that would go on (deviation below 0); 0 cannot be split.
    struct LeafStack {
        GrowingArray<Leaf> leaf;
        GrowingArray<double> distance2;  ///< |eye - m|^2 of its record
        GrowingArray<float> radius, deviation;
        GrowingArray<double> margin;  ///< metres: the least of the other comparisons that made it a leaf

        void clear();
        void push(const Leaf& l, double d2, const SplitRecord& s, double least_margin);
        void shrink(std::size_t leaves);
    };
    /// A tile's lattice in the frame of a patch: u, v of its apex, and 64 times what a step of the lattice adds.
    struct Frame {
        const PlacedTile* tile = nullptr;
        std::int32_t u, v, left_u, left_v, right_u, right_v;
    };
    static constexpr int several = 0;

    int find(const PlacedTile& t, unsigned i, int level);
    int find_in_children(const PlacedTile& t, unsigned i, int level, const Compared& own);
    int find_below(const PlacedTile& t, unsigned i, int level, double margin);
    int push(const PlacedTile& t, unsigned i, int level, double d2, const SplitRecord& s, double margin,
             bool damaged = false);
    void finish(PlacedCell root, int leaves);
    void make(BuiltSegment& segment);
    bool write_strip(const BuiltSegment& segment);
    void write(const Leaf& leaf, unsigned state);
    void enter(const PlacedTile& t);
    std::uint32_t add(const PlacedTile& t, std::uint16_t vertex);
    void certify(BuiltSegment& segment) const;

    const TileSource* tiles_ = nullptr;
    SplitTest test_;
    const SegmentView* view_ = nullptr;
    Purpose purpose_ = Purpose::draw;
    LocationCode half_, patch_;
    std::vector<BuiltSegment>* built_ = nullptr;
    LeafStack stack_;

    const TileLayout& layout_ = tile_layout();
    GrowingArray<SegmentVertex> vertices_;
    GrowingArray<MorphVertex> morphs_;
    GrowingArray<std::uint8_t> leaf_levels_;
    StripWriter strip_;
    Frame frame_;
    std::size_t first_vertex_ = 0;
};

}  // namespace planet
