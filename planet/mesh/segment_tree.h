#pragma once
// Which cells are patches, kept from frame to frame.
//
// From a face downwards a cell is divided while its split test passes and leg < segment_angle * distance does not yet hold.
// Both compare |eye - m| with a number of the cell, so the decision has a slack (see view.h). An odometer adds up the
// eye's steps: what was decided when it showed D holds until it shows D + slack. What is out of view is left as it is, and
// looked at again when it comes into view: what the odometer shows never goes back.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "planet/mesh/culling.h"
#include "planet/mesh/placed_tile.h"
#include "planet/mesh/view.h"

namespace planet {

/// Holds everything in a cell.
struct Sphere {
    glm::dvec3 centre;
    double radius;
};

/// About the split vertex of local cell i of a tile, or that of its parent, if the cell is a leaf where the tile ends. A
/// diamond that does not exist has no radius: its cells are flat, and their corners are the farthest. One that only lacks
/// tiles in memory has: what is in view must not depend on these.
Sphere bounding_sphere(const PlacedTile& t, unsigned i);

struct SegmentView {
    SplitTest test;
    Culling culling;
    /// A patch begins where the root's leg, seen at its least distance, is shorter than this angle (radians): that
    /// bounds the number of lattice samples per pixel from below.
    double segment_angle = 0.1;
    /// A segment is the largest cell within a patch of at most so many leaves, at least 1.
    int segment_leaves = 256;
    double radius_m = 6371008.8;  ///< of the planet
    int detail_level = 24;        ///< bisection level; see Segment::detailed
    /// No patch is of a finer bisection level: below, the lattice of normals would be finer than the data.
    int finest_patch_level = max_bisection_level;
    bool morph = false;  ///< make the stream of Segments::morphs()
    /// How many leaves may be kept that are out of view.
    std::size_t kept_leaves = 500'000;

    /// Whether segments of the other view are right for this one, as far as the eye allows it.
    bool same_but_for_eye_and_culling(const SegmentView& other) const;
};

/// A cell that was looked at.
struct SegmentNode {
    static constexpr std::uint32_t none = 0xffffffff;
    static constexpr double never = -std::numeric_limits<double>::infinity();

    LocationCode cell;
    /// With the cell's record; above it, if the cell is a leaf where the tile ends.
    const PlacedTile* tile = nullptr;
    unsigned local = 0;
    bool divided = false;    ///< larger than a patch, and split
    double expires = never;  ///< all of the above holds until the odometer shows this
    glm::dvec3 centre{0};    ///< everything in the cell is within radius of it
    double radius = 0;
    std::uint32_t children = none;  ///< the first, the second behind it
    std::uint32_t content = none;   ///< of a patch: what its user keeps for it
    std::uint32_t seen = 0;         ///< the last frame in which it was not hidden
};

class SegmentTree {
  public:
    struct InView {
        std::uint32_t node;
        unsigned open;  ///< what culling has to ask of what is in the patch, see CullingTest
    };

    /// Forgets everything.
    void clear();

    /// Finds the patches in view. Since the last clear() views may differ in eye and culling only.
    void update(const TileSource& tiles, const SegmentView& view);

    /// In Sierpinski order. Their content, if any, may be out of date.
    std::span<const InView> in_view() const { return in_view_; }
    SegmentNode& node(std::uint32_t i) { return nodes_[i]; }
    const SegmentNode& node(std::uint32_t i) const { return nodes_[i]; }

    /// Tiles with these roots came, went or changed: forgets patches above and below them.
    void invalidate(std::span<const LocationCode> tile_roots);

    /// What was out of view in the last update and can be dropped, out of view for longest first.
    std::vector<std::uint32_t> hidden_longest_first() const;
    /// Forgets a node's patches.
    void drop(std::uint32_t i);
    /// The content of patches that are no more, since clear_dropped().
    std::span<const std::uint32_t> dropped() const { return dropped_; }
    void clear_dropped() { dropped_.clear(); }

    double odometer() const { return odometer_; }
    /// Something with that slack, taken down now, holds until the odometer shows this.
    double expiry(double slack_m) const;

  private:
    class Visit;
    void move_eye(const glm::dvec3& eye);
    std::uint32_t add_children(std::uint32_t parent);
    void forget(std::uint32_t i);

    std::vector<SegmentNode> nodes_;  // the faces first
    std::vector<std::uint32_t> free_pairs_;
    std::vector<InView> in_view_;
    std::vector<std::uint32_t> hidden_, dropped_;
    glm::dvec3 eye_{0};
    double odometer_ = 0;
    std::uint32_t frame_ = 0;
};

}  // namespace planet
