#pragma once
// Segments: what a picture is drawn from. A segment is all leaves below one cell, with its own strip, its own copies of
// border vertices (the same bits as its neighbours') and coordinates in the 64 x 64 lattice of its patch, where
// per-pixel normals are looked up. From frame to frame, only those whose slack is used up are built again.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "planet/mesh/segment_arrays.h"
#include "planet/mesh/segment_tree.h"

namespace planet {

struct Segment {
    LocationCode root;
    /// Names the square (patch) whose lattice u, v run over: a cell and its neighbour across the split side. The cell is
    /// the root or one above it. The lesser code's apex is (0,0), its left corner (1,0), its right corner (0,1), the
    /// other apex (1,1).
    LocationCode patch;
    std::uint32_t first_vertex, vertex_count, first_index, index_count;
    std::uint32_t leaves;
    std::uint32_t first_leaf;  ///< into leaf_levels(); has room for as many as there are indices
    bool detailed;             ///< holds what is finer than SegmentView::detail_level
};

/// Strips and vertices of all segments in view, in Sierpinski order. Keeps its storage from one use to the next.
///
/// What is in view, and every bit of it, is the same after update() as after build(), whatever came before and whatever
/// the number of threads; but for where it is in vertices() and indices(), and the certificate.
class Segments {
  public:
    Segments();
    Segments(Segments&&) noexcept;
    Segments& operator=(Segments&&) noexcept;
    ~Segments();

    /// Makes all segments anew, one behind the other.
    void build(const TileSource& tiles, const SegmentView& view, int threads = 1);

    /// Builds what the last view leaves to be built. If any but eye and culling has changed, or the source, that is
    /// everything.
    void update(const TileSource& tiles, const SegmentView& view, int threads = 1);

    /// Does ahead what it can of the next update(), which for this view or one nearby is then short. Nothing that can be
    /// asked of segments changes: meanwhile other threads may go on reading them. Does nothing where the update would
    /// build everything.
    void prepare(const TileSource& tiles, const SegmentView& view, int threads = 1);

    /// To be called when tiles of the source came, went or changed: segments above and below these cells are built anew.
    /// Until the next update or prepare no tile is looked at. Nothing that can be asked of segments changes.
    void invalidate(std::span<const LocationCode> tile_roots);

    /// Those in view.
    std::span<const Segment> segments() const { return segments_; }
    /// Segments in view, others that are kept, and gaps.
    std::span<const SegmentVertex> vertices() const { return arrays_.vertices(); }
    /// Parallel to vertices(), if SegmentView::morph.
    std::span<const MorphVertex> morphs() const { return arrays_.morphs(); }
    /// One triangle strip a segment, indices relative to first_vertex.
    std::span<const std::uint32_t> indices() const { return arrays_.indices(); }
    /// The bisection level of each leaf, in the order of the strips.
    std::span<const std::uint8_t> leaf_levels() const { return arrays_.leaf_levels(); }

    /// Of vertices() (and morphs()) and of indices(): what the last build() or update() has written, ascending.
    std::span<const Range> changed_vertices() const { return arrays_.changed_vertices(); }
    std::span<const Range> changed_indices() const { return arrays_.changed_indices(); }
    /// Segments written by the last build() or update().
    std::size_t built() const { return arrays_.written(); }

    /// Sums over the segments in view.
    std::size_t leaf_count() const { return sums_.leaves; }
    std::size_t vertex_count() const { return sums_.vertices; }
    std::size_t index_count() const { return sums_.indices; }
    /// Leaves that are kept though their patches are out of view.
    std::size_t kept_leaves() const { return kept_; }
    /// Whether a damaged tile is among those looked at.
    bool damaged() const { return sums_.damaged; }
    /// The certificate: the largest projected deviation of the picture is at most max_pixel_deviation times this. Exact
    /// after build(); of segments built for another eye update() only knows that it is at most 1, and of what lacks a
    /// tile, by how much it can have grown.
    double ratio_max() const { return sums_.ratio_max; }
    /// The largest deviation of a leaf from the finest surface, metres, exaggerated.
    double deviation_max_m() const { return sums_.deviation_max; }

    /// Of all that is in view but where it is stored: equal for equal segments in equal order.
    std::uint64_t hash() const;

  private:
    struct Piece {
        Segment segment;
        SegmentPlace place;
        Sphere sphere;
        double expires;  ///< see SegmentTree
        double ratio_max, least_reach, deviation_max;
        double odometer;  ///< when it was built
        PlacedCell root;
        bool damaged;
    };
    struct Sums {
        std::size_t leaves = 0, vertices = 0, indices = 0;
        bool damaged = false;
        double ratio_max = 0, deviation_max = 0;

        void add(const Piece& piece, double ratio);
        void add(const Sums& other);
    };
    /// The segments of a patch's half, in Sierpinski order.
    struct Block {
        std::vector<Piece> pieces;
        double expires = SegmentNode::never;  ///< the first of them
        // Of all pieces, and what is needed to say how large a ratio has grown since.
        Sums sums;
        double odometer = 0, least_reach = 0;

        void clear();
    };
    struct InView {
        std::uint32_t block;
        unsigned open;  ///< see SegmentTree::InView
    };
    struct Part;
    struct Job;
    struct Worker;
    void clear();
    void make(const TileSource& tiles, const SegmentView& view, std::size_t threads);
    std::vector<Job> stale_blocks();
    void build_all(const TileSource& tiles, std::span<Job> jobs, std::size_t threads);
    void build(const TileSource& tiles, Job& job, Worker& worker) const;
    void place(const Job& job);
    Piece new_piece(const BuiltSegment& b, const SegmentBuilder& builder, const Piece* old);
    double ratio_since(double odometer, double ratio_max, double least_reach) const;
    void list();
    void list_culled(const Block& block, const CullingTest& culling, unsigned open);
    void release_dropped();
    void release(const Piece& piece);
    void shed_unseen();

    SegmentView view_;  // of the last update
    const TileSource* tiles_from_ = nullptr;
    bool listed_ = false;  // segments_ is that of view_
    // What is made, for a view that is that of the last update or the one prepared for.
    SegmentView made_for_;
    bool made_ = false;  // and no tile has changed since
    SegmentTree tree_;
    std::vector<Block> blocks_;
    std::vector<std::uint32_t> free_blocks_;
    std::vector<InView> in_view_;
    std::vector<std::unique_ptr<Worker>> workers_;

    SegmentArrays arrays_;
    std::vector<Segment> segments_;
    std::size_t total_leaves_ = 0, block_leaves_ = 0, kept_ = 0;
    Sums sums_;
};

}  // namespace planet
