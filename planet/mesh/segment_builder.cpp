#include "planet/mesh/segment_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/lanes.h"
#include "planet/mesh/morph.h"

namespace planet {

namespace {

constexpr std::int32_t one = 32768;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// By how much |eye - m| < reach is decided.
inline double margin_of(double distance2, double reach) {
    return std::abs(std::sqrt(distance2) - reach);
}

/// u, v of the corners left, right, apex of a tile.
struct TileCorners {
    std::int32_t u[3], v[3];
};

/// The corners of a tile such that the apex, left and right of cell `half` are (0,0), (1,0), (0,1); or of the patch's far
/// half, where they are (1,1), (0,1), (1,0). One of the two cells contains the other.
TileCorners corners_of_tile(LocationCode tile, LocationCode half, bool far_half) {
    const TileLayout& layout = tile_layout();
    TileCorners f{.u = {one, 0, 0}, .v = {0, one, 0}};
    const int below = half.bisection_level() - tile.bisection_level();
    if (below < 0) {  // from the half down to the tile: corners left, right, apex of each child
        for (int i = -below - 1; i >= 0; --i)
            for (std::int32_t* p : {f.u, f.v}) {
                const std::int32_t m = (p[0] + p[1]) / 2;
                p[tile.bits() >> i & 1 ? 0 : 1] = p[2];
                p[2] = m;
            }
    } else {
        const auto local = static_cast<std::size_t>((half.bits() ^ tile.bits() << below) | std::uint64_t{1} << below);
        const auto point = [&](std::size_t k) {
            const auto& p = layout.lattice[layout.corners[local][k]];
            return glm::ivec2(p[0], p[1]);
        };
        const glm::ivec2 left = point(0) - point(2), right = point(1) - point(2), apex = point(2);
        const int leg2 = left.x * left.x + left.y * left.y;  // the legs are equal and at right angles
        const glm::ivec2 tile_corners[3] = {{64, 0}, {0, 64}, {0, 0}};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 p = tile_corners[k] - apex;
            f.u[k] = one * (p.x * left.x + p.y * left.y) / leg2;
            f.v[k] = one * (p.x * right.x + p.y * right.y) / leg2;
        }
    }
    if (far_half)
        for (std::size_t k = 0; k < 3; ++k) {
            f.u[k] = one - f.u[k];
            f.v[k] = one - f.v[k];
        }
    return f;
}

/// The first cell of a tile that a vertex splits, by vertex.
const std::array<std::uint16_t, tile_vertices>& split_cells() {
    static const auto table = [] {
        std::array<std::uint16_t, tile_vertices> t{};
        for (unsigned i = tile_cells - 1; i >= 1; --i) t[tile_layout().split_vertex[i]] = static_cast<std::uint16_t>(i);
        return t;
    }();
    return table;
}

/// @param vertex of tile t
MorphVertex morph_of(const TileSource& tiles, const PlacedTile* t, std::size_t vertex, double planet_radius_m) {
    const TileLayout& layout = tile_layout();
    const GridPosition place = t->position[vertex];
    while (vertex < 3) {  // a corner: it splits a cell of a tile above
        if (t->root.bisection_level() == 0) return {};
        const TileLayers layers = tiles.layers();
        const unsigned local = layers.local_above(t->root);
        t = tiles.tile(layers.above(t->root));
        if (t == nullptr) return {};
        vertex = layout.corners[local][vertex];
    }
    const GridPosition &a = t->position[layout.ends[vertex][0]], &b = t->position[layout.ends[vertex][1]];
    const auto offset = [&](int axis) {
        const std::int64_t twice =
            grid_coordinate(a, axis) + grid_coordinate(b, axis) - 2 * grid_coordinate(place, axis);
        return static_cast<float>(static_cast<double>(twice) * (0.5 * grid_unit_m));
    };
    const unsigned cell = split_cells()[vertex];
    const int level = t->root.bisection_level() + static_cast<int>(std::bit_width(cell)) - 1;
    const SplitRecord s = t->split[cell];
    const double width = arrival_width(level, static_cast<double>(s.radius), planet_radius_m);
    return {offset(0), offset(1), offset(2), s.deviation, s.radius, static_cast<float>(width)};
}

}  // namespace

void SegmentBuilder::begin(const TileSource& tiles, const SegmentView& view, Purpose purpose) {
    tiles_ = &tiles;
    test_ = view.test;
    view_ = &view;
    purpose_ = purpose;
    vertices_.clear();
    morphs_.clear();
    leaf_levels_.clear();
    strip_.clear();
}

void SegmentBuilder::build(const PlacedCell& cell, LocationCode half, std::vector<BuiltSegment>& built) {
    half_ = half.ancestor(std::min(half.bisection_level(), view_->finest_patch_level));
    patch_ = diamond(half_);
    built_ = &built;
    frame_.tile = nullptr;
    stack_.clear();
    const auto first = static_cast<std::ptrdiff_t>(built.size());
    if (const int leaves = find(*cell.tile, cell.local, cell.code().bisection_level()); leaves != several)
        finish(cell, leaves);
    std::sort(built.begin() + first, built.end(), [](const BuiltSegment& a, const BuiltSegment& b) {
        return a.cell.first_at(max_bisection_level) < b.cell.first_at(max_bisection_level);
    });
}

void SegmentBuilder::LeafStack::clear() {
    shrink(leaf.size());
}

inline void SegmentBuilder::LeafStack::push(const Leaf& l, double d2, const SplitRecord& s, double least_margin) {
    if (leaf.room() < lane_count) {  // whole lanes are read
        leaf.reserve_more(lane_count);
        distance2.reserve_more(lane_count);
        radius.reserve_more(lane_count);
        deviation.reserve_more(lane_count);
        margin.reserve_more(lane_count);
    }
    leaf.push(l);
    distance2.push(d2);
    radius.push(s.radius);
    deviation.push(s.deviation);
    margin.push(least_margin);
}

void SegmentBuilder::LeafStack::shrink(std::size_t leaves) {
    const std::size_t size = leaf.size() - leaves;
    leaf.resize(size);
    distance2.resize(size);
    radius.resize(size);
    deviation.resize(size);
    margin.resize(size);
}

// The apex is the vertex that the leaf or its sibling will most likely add.
inline int SegmentBuilder::push(const PlacedTile& t, unsigned i, int level, double d2, const SplitRecord& s,
                                double margin, bool damaged) {
    const std::uint16_t apex = layout_.corners[i][2];
    __builtin_prefetch(&t.position[apex]);
    __builtin_prefetch(&t.height[apex]);
    stack_.push({&t, static_cast<std::uint16_t>(i), static_cast<std::uint8_t>(level), t.damaged || damaged}, d2, s,
                margin);
    return 1;
}

// find... return how many leaves a cell has left on the stack, at most segment_leaves, or `several` segments.
int SegmentBuilder::find(const PlacedTile& t, unsigned i, int level) {
    if (i >> t.depth) return find_below(t, i, level, infinity);
    const SplitRecord s = t.split[i];
    const Compared own{test_.distance2(s), test_.reach(s)};
    return test_(s) ? find_in_children(t, i, level, own) : push(t, i, level, own.distance2, s, infinity);
}

// A leaf stays one while its own test fails and that of its parent passes: then all above pass, as the test is nested.
// @param own comparison of cell i
int SegmentBuilder::find_in_children(const PlacedTile& t, unsigned i, int level, const Compared& own) {
    const unsigned first = 2 * i, second = first + 1;
    int a, b;
    ++level;
    if (first >> t.depth) {
        const double margin = margin_of(own.distance2, own.reach);
        a = find_below(t, first, level, margin);
        b = find_below(t, second, level, margin);
    } else {
        // Both are tested before either is walked: the tests overlap.
        const SplitRecord s0 = t.split[first], s1 = t.split[second];
        const Compared c0{test_.distance2(s0), test_.reach(s0)}, c1{test_.distance2(s1), test_.reach(s1)};
        const bool split0 = s0.deviation > 0 && c0.distance2<c0.reach * c0.reach, split1 = s1.deviation> 0 &&
                            c1.distance2 < c1.reach * c1.reach;
        if (split1 && !(2 * second >> t.depth)) {  // while the first is walked
            t.split.prefetch(2 * second);
            t.split.prefetch(2 * second + 1);
        }
        const double margin = split0 && split1 ? infinity : margin_of(own.distance2, own.reach);
        a = split0 ? find_in_children(t, first, level, c0) : push(t, first, level, c0.distance2, s0, margin);
        b = split1 ? find_in_children(t, second, level, c1) : push(t, second, level, c1.distance2, s1, margin);
    }
    if (a != several && b != several && a + b <= view_->segment_leaves) return a + b;
    if (b != several) finish({&t, second}, b);
    if (a != several) finish({&t, first}, a);
    return several;
}

// Where the tile ends: a leaf, unless a tile below goes on. @param margin that of the parent
int SegmentBuilder::find_below(const PlacedTile& t, unsigned i, int level, double margin) {
    constexpr SplitRecord none{};
    if (t.child_bound.empty()) return push(t, i, level, 0, none, margin);
    const unsigned k = t.position_below(i);
    const SplitRecord bound = t.child_bound[k];
    const Compared at_bound{test_.distance2(bound), test_.reach(bound)};
    if (!test_(bound)) return push(t, i, level, at_bound.distance2, bound, margin);
    margin = std::min(margin, margin_of(at_bound.distance2, at_bound.reach));
    const PlacedTile* below = t.child(*tiles_, k);
    if (!below) {
        const SplitRecord wanting{bound.x, bound.y, bound.z, -bound.deviation, bound.radius};
        return push(t, i, level, at_bound.distance2, wanting, margin);
    }
    const SplitRecord s = below->split[1];
    const Compared own{test_.distance2(s), test_.reach(s)};
    if (test_(s)) return find_in_children(*below, 1, level, own);
    return push(t, i, level, own.distance2, s, margin, below->damaged);
}

/// Makes a segment of the uppermost leaves of the stack.
void SegmentBuilder::finish(PlacedCell root, int leaves) {
    if (root.local >> root.tile->depth && leaves > 1)  // not a leaf: the tile below has its record
        root = {root.tile->child(*tiles_, root.tile->position_below(root.local)), 1};
    BuiltSegment segment{.root = root,
                         .cell = root.code(),
                         .patch = patch_,
                         .sphere = bounding_sphere(*root.tile, root.local),
                         .leaves = static_cast<std::uint32_t>(leaves)};
    if (purpose_ == Purpose::draw) make(segment);
    built_->push_back(segment);
    stack_.shrink(segment.leaves);
}

void SegmentBuilder::make(BuiltSegment& segment) {
    segment.first_index = static_cast<std::uint32_t>(strip_.indices().size());
    segment.first_leaf = static_cast<std::uint32_t>(leaf_levels_.size());
    segment.first_vertex = static_cast<std::uint32_t>(vertices_.size());
    strip_.reserve(segment.leaves + 1);
    vertices_.reserve_more(segment.leaves + 2);
    leaf_levels_.reserve_more(segment.leaves);
    if (view_->morph) morphs_.reserve_more(segment.leaves + 2);
    first_vertex_ = segment.first_vertex;
    segment.damaged = write_strip(segment);
    certify(segment);

    const PlacedTile& t = *segment.root.tile;
    const int tile_level = t.root.bisection_level();
    segment.vertices = static_cast<std::uint32_t>(vertices_.size()) - segment.first_vertex;
    segment.indices = static_cast<std::uint32_t>(strip_.indices().size()) - segment.first_index;
    // Tiles below are there for what is finer than where they begin: nearly all of it is as fine as asked for, if that is
    // at most a few levels more.
    constexpr int few = 4;
    const int end_level = tile_level + t.depth;
    segment.detailed = end_level > view_->detail_level ||
                       (end_level + few > view_->detail_level && t.has_child_below(segment.root.local));
}

/// Returns whether a damaged tile is among those looked at.
bool SegmentBuilder::write_strip(const BuiltSegment& segment) {
    const int level = segment.cell.bisection_level();
    strip_.end();
    // The states on the way down to a leaf; its path from the root, a bit a level.
    std::array<std::uint8_t, max_bisection_level + 1> state;
    state[0] = static_cast<std::uint8_t>(strip_state_of_segment(segment.cell));
    std::uint64_t path = 0;
    std::size_t depth = 0;
    bool damaged = false;
    for (const Leaf& leaf : stack_.leaf.span().last(segment.leaves)) {
        for (; depth < static_cast<std::size_t>(leaf.level - level); ++depth, path <<= 1)
            state[depth + 1] = strip_child_states[state[depth]][0];
        write(leaf, state[depth]);
        damaged = damaged || leaf.damaged;
        const int finished = std::countr_one(path);
        path = path >> finished | 1;
        depth -= static_cast<std::size_t>(finished);
        if (depth > 0) state[depth] = strip_child_states[state[depth - 1]][1];
    }
    return damaged;
}

void SegmentBuilder::write(const Leaf& leaf, unsigned state) {
    const PlacedTile& t = *leaf.tile;
    if (&t != frame_.tile) enter(t);
    strip_.leaf(state, [&](std::size_t corner) { return add(t, layout_.corners[leaf.local][corner]); });
    leaf_levels_.push(leaf.level);
}

void SegmentBuilder::enter(const PlacedTile& t) {
    const TileCorners c = corners_of_tile(t.root, half_, patch_ != half_);
    frame_ = {&t, c.u[2], c.v[2], c.u[0] - c.u[2], c.v[0] - c.v[2], c.u[1] - c.u[2], c.v[1] - c.v[2]};
}

std::uint32_t SegmentBuilder::add(const PlacedTile& t, std::uint16_t vertex) {
    const std::int32_t i = layout_.lattice[vertex][0], j = layout_.lattice[vertex][1];
    vertices_.push(
        {t.position[vertex], static_cast<std::uint16_t>(frame_.u + (frame_.left_u * i + frame_.right_u * j) / 64),
         static_cast<std::uint16_t>(frame_.v + (frame_.left_v * i + frame_.right_v * j) / 64), t.height[vertex]});
    if (view_->morph) morphs_.push(morph_of(*tiles_, &t, vertex, view_->radius_m));
    return static_cast<std::uint32_t>(vertices_.size() - 1 - first_vertex_);
}

// Of the uppermost leaves of the stack: how far the eye may move, and what is not split, its deviation over what the test
// allows at the nearest point below it.
void SegmentBuilder::certify(BuiltSegment& segment) const {
    const std::size_t end = stack_.leaf.size();
    const Lanes K = Lanes{} + test_.K, endless = Lanes{} + infinity, zero{};
    Lanes margin = endless, least_reach = endless, ratio = zero, deviation_max = zero;
    for (std::size_t at = end - segment.leaves; at < end; at += lane_count) {
        const WholeLanes counted = lane_numbers() < static_cast<std::int64_t>(end - at);
        const Lanes deviation = counted ? widened_lanes(&stack_.deviation[at]) : zero,
                    radius = widened_lanes(&stack_.radius[at]), scaled = K * absolute(deviation),
                    distance = square_root(load_lanes(&stack_.distance2[at])), beyond = larger(distance - radius, zero);
        margin = smaller(margin, counted ? load_lanes(&stack_.margin[at]) : endless);
        margin = smaller(margin, deviation != zero ? absolute(distance - (radius + scaled)) : endless);
        least_reach = smaller(least_reach, (deviation < zero) & (distance < radius + scaled) ? beyond : endless);
        ratio = larger(ratio, deviation != zero ? scaled / beyond : zero);
        deviation_max = larger(deviation_max, absolute(deviation));
    }
    Slack slack(test_.eye);
    slack.add_margin(least_lane(margin));
    segment.slack = slack.metres();
    segment.least_reach = least_lane(least_reach);
    segment.ratio_max = -least_lane(-ratio);
    segment.deviation_max = -least_lane(-deviation_max);
}

}  // namespace planet
