#pragma once
// Segments: what a picture is drawn from. A segment is all leaves below one cell, with its own strip, its own copies of
// border vertices (the same bits as its neighbours') and coordinates in the 64 x 64 lattice of its root's diamond,
// where per-pixel normals are looked up. Segments out of view are not built.

#include <span>
#include <vector>

#include "planet/mesh/culling.h"
#include "planet/mesh/growing_array.h"
#include "planet/mesh/placed_tile.h"
#include "planet/mesh/view.h"

namespace planet {

/// 24 bytes, as the GPU takes them.
struct SegmentVertex {
    GridPosition position;
    std::uint16_t u, v;  ///< 32768 = 1, in the frame of the segment's patch
    float height;        ///< metres above the store's datum, not exaggerated
};
static_assert(sizeof(SegmentVertex) == 24);

struct Segment {
    LocationCode root;
    /// Names the square (patch) whose lattice u, v run over: a cell and its neighbour across the split side. The cell is
    /// the root, or its ancestor at SegmentView::finest_patch_level. The
    /// lesser code's apex is (0,0), its left corner (1,0), its right corner (0,1), the other apex (1,1).
    LocationCode patch;
    double distance_m;  ///< least distance from the eye to anything in the segment; a lower bound
    std::uint32_t first_vertex, first_index, index_count;
    std::uint32_t leaves;
    std::uint32_t first_leaf;  ///< into leaf_levels()
    bool detailed;             ///< holds tiles rooted at SegmentView::detail_level or deeper
};

struct SegmentView {
    SplitTest test;
    Culling culling;
    /// A segment ends where the root's leg, seen at its least distance, is shorter than this angle (radians): that
    /// bounds the number of lattice samples per pixel from below.
    double segment_angle = 0.1;
    double radius_m = 6371008.8;  ///< of the planet
    int detail_level = 24;        ///< bisection level, a multiple of 12; see Segment::detailed
    /// No patch is of a finer bisection level: below, the lattice of normals would be finer than the data.
    int finest_patch_level = max_bisection_level;
};

/// Strips and vertices of all segments in view, in Sierpinski order. Keeps its storage from one use to the next.
class Segments {
  public:
    /// Replaces the segments. The result does not depend on the number of threads.
    void build(const TileSource& tiles, const SegmentView& view, int threads = 1);

    std::span<const Segment> segments() const { return segments_; }
    std::span<const SegmentVertex> vertices() const { return vertices_; }
    /// One triangle strip a segment, indices relative to first_vertex.
    std::span<const std::uint32_t> indices() const { return indices_; }
    /// The bisection level of each leaf, in the order of the strips.
    std::span<const std::uint8_t> leaf_levels() const { return leaf_levels_; }
    /// How often the walk entered a tile below a segment's own, and whether one stands in for a damaged tile.
    std::size_t tiles() const { return tiles_; }
    bool damaged() const { return damaged_; }
    /// The certificate: the largest projected deviation of the picture is at most max_pixel_deviation times this.
    double ratio_max() const { return ratio_max_; }
    /// The largest deviation of a leaf from the finest surface, metres, exaggerated.
    double deviation_max_m() const { return deviation_max_; }

  private:
    std::vector<Segment> segments_;
    std::vector<SegmentVertex> vertices_;
    std::vector<std::uint32_t> indices_;
    std::vector<std::uint8_t> leaf_levels_;
    std::size_t tiles_ = 0;
    bool damaged_ = false;
    double ratio_max_ = 0, deviation_max_ = 0;
};

}  // namespace planet
