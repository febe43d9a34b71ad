#include "planet/mesh/segment_tree.h"

#include <algorithm>
#include <cmath>

#include "planet/octahedron/cell_metrics.h"

namespace planet {

namespace {

/// Room is made for them at once, see segments.cpp.
constexpr std::size_t usual_nodes = 1 << 18;

}  // namespace

Sphere bounding_sphere(const PlacedTile& t, unsigned local) {
    if (local >> t.depth) local >>= 1;
    const SplitRecord s = t.split[local];
    const glm::dvec3 centre(s.x, s.y, s.z);
    if (s.deviation != 0) return {centre, static_cast<double>(s.radius)};
    double radius = 0;
    for (const std::uint16_t corner : tile_layout().corners[local])
        radius = std::max(radius, glm::distance(centre, ecef_from_grid(t.position[corner])));
    return {centre, radius};
}

bool SegmentView::same_but_for_eye_and_culling(const SegmentView& other) const {
    return test.K == other.test.K && segment_angle == other.segment_angle && segment_leaves == other.segment_leaves &&
           radius_m == other.radius_m && detail_level == other.detail_level &&
           finest_patch_level == other.finest_patch_level && morph == other.morph;
}

/// One update.
class SegmentTree::Visit {
  public:
    Visit(SegmentTree& tree, const TileSource& tiles, const SegmentView& view)
        : tree_(tree), tiles_(tiles), view_(view), culling_(view.culling) {
        for (int level = 0; level <= max_bisection_level; ++level) {
            const double leg = cell_metrics(level).split_max * view.radius_m / std::sqrt(2.0);
            patch_reach_[static_cast<std::size_t>(level)] = leg + leg / view.segment_angle;
        }
    }

    void face(int face) {
        if (tree_.odometer_ >= tree_.nodes_[static_cast<std::size_t>(face)].expires) {
            const PlacedTile* tile = tiles_.tile(LocationCode::face_root(face));
            assert(tile != nullptr);
            Slack slack(view_.test.eye);
            look_at(tree_.nodes_[static_cast<std::size_t>(face)], *tile, 1, slack);
        }
        visit(static_cast<std::uint32_t>(face), culling_.everything());
    }

  private:
    // @param open see CullingTest
    void visit(std::uint32_t i, unsigned open) {
        SegmentNode& n = tree_.nodes_[i];
        if (culling_.hidden(n.centre, n.radius, open)) {
            if (n.children != SegmentNode::none || n.content != SegmentNode::none) tree_.hidden_.push_back(i);
            return;
        }
        n.seen = tree_.frame_;
        if (!n.divided) {
            tree_.forget(n.children);
            n.children = SegmentNode::none;
            tree_.in_view_.push_back({i, open});
            return;
        }
        if (n.content != SegmentNode::none) {
            tree_.dropped_.push_back(n.content);
            n.content = SegmentNode::none;
        }
        const std::uint32_t children = n.children != SegmentNode::none ? n.children : tree_.add_children(i);
        for (const std::uint32_t child : {children, children + 1}) {
            if (tree_.odometer_ >= tree_.nodes_[child].expires) look_at_child(i, child);
            visit(child, open);
        }
    }

    // A leaf where the tile ends, unless the tile below goes on.
    void look_at_child(std::uint32_t parent, std::uint32_t child) {
        const SegmentNode& above = tree_.nodes_[parent];
        SegmentNode& n = tree_.nodes_[child];
        const PlacedTile* t = above.tile;
        unsigned local = 2 * above.local + static_cast<unsigned>(n.cell.child_index());
        Slack slack(view_.test.eye);
        if (local >> t->depth && !t->child_bound.empty()) {
            const unsigned k = t->position_below(local);
            slack.add(view_.test, t->child_bound[k]);
            if (const PlacedTile* below = t->child(tiles_, k, view_.test)) {
                slack.add(view_.test, opened(below->split[1]));
                if (view_.test(below->split[1])) {
                    t = below;
                    local = 1;
                }
            }
        }
        look_at(n, *t, local, slack);
    }

    void look_at(SegmentNode& n, const PlacedTile& t, unsigned local, Slack& slack) {
        n.tile = &t;
        n.local = local;
        const Sphere sphere = bounding_sphere(t, local);
        n.centre = sphere.centre;
        n.radius = sphere.radius;
        n.divided = false;
        if (!(local >> t.depth)) {
            const SplitRecord s = t.split[local];
            const double patch_reach = patch_reach_[static_cast<std::size_t>(n.cell.bisection_level())];
            const double distance2 = view_.test.distance2(s);
            n.divided = view_.test(s) && distance2 < patch_reach * patch_reach;
            slack.add(view_.test, opened(s));
            if (s.deviation > 0) slack.add(distance2, patch_reach);
        }
        n.expires = tree_.expiry(slack.metres());
    }

    SegmentTree& tree_;
    const TileSource& tiles_;
    const SegmentView& view_;
    CullingTest culling_;
    std::array<double, max_bisection_level + 1> patch_reach_;  // from the split vertex, by bisection level
};

void SegmentTree::clear() {
    nodes_.clear();
    free_pairs_.clear();
    in_view_.clear();
    hidden_.clear();
    dropped_.clear();
    odometer_ = 0;
    frame_ = 0;
}

// Both roundings are upwards: the odometer shows at least what the eye has gone.
void SegmentTree::move_eye(const glm::dvec3& eye) {
    const double step = glm::distance(eye, eye_);
    if (step > 0) odometer_ = std::nextafter(odometer_ + step * (1 + 1e-14), std::numeric_limits<double>::infinity());
    eye_ = eye;
}

double SegmentTree::expiry(double slack_m) const {
    return std::nextafter(odometer_ + slack_m, -std::numeric_limits<double>::infinity());
}

void SegmentTree::update(const TileSource& tiles, const SegmentView& view) {
    if (nodes_.empty()) {
        eye_ = view.test.eye;
        nodes_.reserve(usual_nodes);
        for (int face = 0; face < face_count; ++face)
            nodes_.push_back(SegmentNode{.cell = LocationCode::face_root(face)});
    }
    move_eye(view.test.eye);
    ++frame_;
    in_view_.clear();
    hidden_.clear();
    Visit visit(*this, tiles, view);
    for (int rank = 0; rank < face_count; ++rank) visit.face(face_at_loop_rank(rank));
}

std::uint32_t SegmentTree::add_children(std::uint32_t parent) {
    std::uint32_t first;
    if (free_pairs_.empty()) {
        first = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
    } else {
        first = free_pairs_.back();
        free_pairs_.pop_back();
    }
    nodes_[parent].children = first;
    for (std::uint32_t k = 0; k < 2; ++k)
        nodes_[first + k] = SegmentNode{.cell = nodes_[parent].cell.child(static_cast<int>(k))};
    return first;
}

/// @param i a pair of children, or none
void SegmentTree::forget(std::uint32_t i) {
    if (i == SegmentNode::none) return;
    for (const std::uint32_t child : {i, i + 1}) drop(child);
    free_pairs_.push_back(i);
}

void SegmentTree::drop(std::uint32_t i) {
    SegmentNode& n = nodes_[i];
    forget(n.children);
    n.children = SegmentNode::none;
    if (n.content != SegmentNode::none) dropped_.push_back(n.content);
    n.content = SegmentNode::none;
    n.expires = SegmentNode::never;
}

void SegmentTree::invalidate(std::span<const LocationCode> tile_roots) {
    if (nodes_.empty()) return;
    for (const LocationCode root : tile_roots) {
        auto i = static_cast<std::uint32_t>(root.face());
        for (int level = root.bisection_level() - 1;; --level) {
            SegmentNode& n = nodes_[i];
            n.expires = SegmentNode::never;
            if (level < 0 || n.children == SegmentNode::none) {
                drop(i);
                break;
            }
            i = n.children + static_cast<std::uint32_t>(root.bits() >> level & 1);
        }
    }
}

std::vector<std::uint32_t> SegmentTree::hidden_longest_first() const {
    std::vector<std::uint32_t> list = hidden_;
    std::stable_sort(list.begin(), list.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return nodes_[a].seen < nodes_[b].seen; });
    return list;
}

}  // namespace planet
