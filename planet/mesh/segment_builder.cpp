#include "planet/mesh/segment_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planet {

namespace {

constexpr std::int32_t one = 32768;

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
MorphVertex morph_of(const TileSource& tiles, const PlacedTile* t, std::size_t vertex) {
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
    const SplitRecord s = t->split[split_cells()[vertex]];
    return {offset(0), offset(1), offset(2), s.deviation, s.radius};
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

// The apex is the vertex that the leaf or its sibling will most likely add.
inline int SegmentBuilder::push(const PlacedTile& t, unsigned i, int level) {
    const std::uint16_t apex = layout_.corners[i][2];
    __builtin_prefetch(&t.position[apex]);
    __builtin_prefetch(&t.height[apex]);
    stack_.reserve_more(1);
    stack_.push({&t, static_cast<std::uint16_t>(i), static_cast<std::uint8_t>(level)});
    return 1;
}

// find... return how many leaves a cell has left on the stack, at most segment_leaves, or `several` segments.
int SegmentBuilder::find(const PlacedTile& t, unsigned i, int level) {
    if (i >> t.depth) return find_below(t, i, level);
    return test_(t.split[i]) ? find_in_children(t, i, level) : push(t, i, level);
}

int SegmentBuilder::find_in_children(const PlacedTile& t, unsigned i, int level) {
    const unsigned first = 2 * i, second = first + 1;
    int a, b;
    ++level;
    if (first >> t.depth) {
        a = find_below(t, first, level);
        b = find_below(t, second, level);
    } else {
        // Both are tested before either is walked: the tests overlap.
        const bool first_split = test_(t.split[first]), second_split = test_(t.split[second]);
        a = first_split ? find_in_children(t, first, level) : push(t, first, level);
        b = second_split ? find_in_children(t, second, level) : push(t, second, level);
    }
    if (a != several && b != several && a + b <= view_->segment_leaves) return a + b;
    if (b != several) finish({&t, second}, b);
    if (a != several) finish({&t, first}, a);
    return several;
}

// Where the tile ends: a leaf, unless a tile below goes on.
int SegmentBuilder::find_below(const PlacedTile& t, unsigned i, int level) {
    const PlacedTile* below = t.child(*tiles_, t.position_below(i), test_);
    if (below && test_(below->split[1])) return find_in_children(*below, 1, level);
    return push(t, i, level);
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
    stack_.resize(stack_.size() - segment.leaves);
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
    slack_ = Slack(test_.eye);
    leaf_before_.tile = nullptr;
    damaged_ = false;
    ratio_max_ = deviation_max_ = 0;
    worth_ = least_reach_ = std::numeric_limits<double>::infinity();
    write_strip(segment);

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
    segment.damaged = damaged_;
    segment.slack = slack_.metres();
    segment.ratio_max = ratio_max_;
    segment.least_reach = least_reach_;
    segment.deviation_max = deviation_max_;
}

void SegmentBuilder::write_strip(const BuiltSegment& segment) {
    const int level = segment.cell.bisection_level();
    strip_.end();
    // The states on the way down to a leaf; its path from the root, a bit a level.
    std::array<std::uint8_t, max_bisection_level + 1> state;
    state[0] = static_cast<std::uint8_t>(strip_state_of_segment(segment.cell));
    std::uint64_t path = 0;
    std::size_t depth = 0;
    for (const Leaf& leaf : stack_.span().last(segment.leaves)) {
        for (; depth < static_cast<std::size_t>(leaf.level - level); ++depth, path <<= 1)
            state[depth + 1] = strip_child_states[state[depth]][0];
        write(leaf, state[depth]);
        certify(leaf, depth == 0);
        const int finished = std::countr_one(path);
        path = path >> finished | 1;
        depth -= static_cast<std::size_t>(finished);
        if (depth > 0) state[depth] = strip_child_states[state[depth - 1]][1];
    }
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
    if (view_->morph) morphs_.push(morph_of(*tiles_, &t, vertex));
    return static_cast<std::uint32_t>(vertices_.size() - 1 - first_vertex_);
}

// A diamond that is not split: its slack, if it could be, and its deviation over what the test allows at the nearest point
// below it.
inline void SegmentBuilder::certify(const SplitRecord& s, bool can_split) {
    if (s.deviation == 0) return;
    const double deviation = std::abs(static_cast<double>(s.deviation)), scaled = test_.K * deviation;
    deviation_max_ = std::max(deviation_max_, deviation);
    const double d2 = test_.distance2(s), r = static_cast<double>(s.radius);
    if (can_split)
        slack_.add(d2, r + scaled);
    else
        least_reach_ = std::min(least_reach_, std::max(std::sqrt(d2) - r, 0.0));
    // scaled / (d - r) > ratio_max without a root or a division: most leaves are not the worst.
    if (const double within = scaled * worth_ + r; d2 < within * within) [[unlikely]] {
        ratio_max_ = std::max(ratio_max_, scaled / std::max(std::sqrt(d2) - r, 0.0));
        worth_ = 1 / ratio_max_;
    }
}

// The leaf must go on to fail its test, and its parent to pass: then all above it pass, as the test is nested.
void SegmentBuilder::certify(const Leaf& leaf, bool whole_segment) {
    const PlacedTile& t = *leaf.tile;
    const unsigned i = leaf.local;
    damaged_ = damaged_ || t.damaged;
    const bool sibling_was_leaf = (i & 1) != 0 && leaf_before_.tile == &t && leaf_before_.local == i - 1;
    leaf_before_ = leaf;
    if (!whole_segment && !sibling_was_leaf) slack_.add(test_, t.split[i >> 1]);
    if (!(i >> t.depth)) {
        const SplitRecord s = t.split[i];
        certify(s, s.deviation > 0);
    } else if (!t.child_bound.empty()) {
        const unsigned k = t.position_below(i);
        const SplitRecord& bound = t.child_bound[k];
        const PlacedTile* below = t.child(*tiles_, k, test_);
        if (test_(bound)) {
            slack_.add(test_, bound);
            const SplitRecord s = below ? below->split[1] : bound;
            certify(s, below && s.deviation > 0);
        } else {
            certify(bound, true);
        }
        damaged_ = damaged_ || (below && below->damaged);
    }
}

}  // namespace planet
