#pragma once
// Where segments lie: places in arrays, for pieces that come and go.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/growing_array.h"
#include "planet/mesh/range_allocator.h"
#include "planet/mesh/segment_builder.h"

namespace planet {

/// A segment may be smaller than its place.
struct SegmentPlace {
    Range vertices, indices;  ///< the levels of its leaves have the place of its indices
};

/// Arrays of all segments, and what of them has changed. A segment that was built is given a place first and written
/// later: places may be taken and let go on one thread while the arrays are read by others.
class SegmentArrays {
  public:
    /// A place for a segment that was built. It lies in the builder until it is written.
    /// @param old that of the segment it takes the place of, or nullptr
    SegmentPlace place(const BuiltSegment& built, const SegmentBuilder& builder, const SegmentPlace* old);
    void release(const SegmentPlace& place);

    /// Forgets what was changed until now.
    void begin_changes();
    /// Writes what was given a place since the last time. @param morph vertices morph
    void write(bool morph, std::size_t threads);
    /// After the last write(): makes changed_...() ascending lists.
    void end_changes();

    /// Forgets all segments.
    void clear();

    std::span<const SegmentVertex> vertices() const { return vertices_.span(); }
    std::span<const MorphVertex> morphs() const { return morphs_.span(); }
    std::span<const std::uint32_t> indices() const { return indices_.span(); }
    std::span<const std::uint8_t> leaf_levels() const { return leaf_levels_.span(); }
    std::span<const Range> changed_vertices() const { return changed_vertices_; }
    std::span<const Range> changed_indices() const { return changed_indices_; }
    /// Segments written since begin_changes().
    std::size_t written() const { return written_; }
    /// Whether all that was given a place is written.
    bool all_written() const { return unwritten_.empty(); }

  private:
    struct Unwritten {
        const SegmentBuilder* from;
        BuiltSegment segment;
        SegmentPlace place;
    };
    void reserve(bool morph);
    void resize(bool morph);
    void write(const Unwritten& u, bool morph);

    RangeAllocator vertex_places_, index_places_;
    GrowingArray<SegmentVertex> vertices_;
    GrowingArray<MorphVertex> morphs_;
    GrowingArray<std::uint32_t> indices_;
    GrowingArray<std::uint8_t> leaf_levels_;
    std::vector<Unwritten> unwritten_;
    std::vector<Range> changed_vertices_, changed_indices_;
    std::size_t written_ = 0;
};

}  // namespace planet
