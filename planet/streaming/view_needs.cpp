#include "planet/streaming/view_needs.h"

#include <cmath>
#include <limits>
#include <utility>

#include "planet/octahedron/cell_metrics.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

glm::dvec3 centre_of(const SplitRecord& record) {
    return {record.x, record.y, record.z};
}

}  // namespace

void ViewNeeds::add(const SegmentView& view) {
    view_ = &view;
    for (int face = 0; face < face_count; ++face) {
        follow(resident_.face(face));
        visit(resident_.face(face), 1, false);
    }
}

void ViewNeeds::visit(ResidentTile& tile, unsigned i, bool in_segment) {
    if (i >> tile.tile->depth) return visit_below(tile, tile.tile->position_below(i), in_segment);
    if (!tile.tile->has_child_below(i)) return;
    const SplitRecord record = opened(tile.tile->split[i]);
    if (!view_->test(record) || (!in_segment && hidden(record))) return;
    in_segment = in_segment || ends_patch(record, tile.root.bisection_level() + relative_level(i));
    visit(tile, 2 * i, in_segment);
    visit(tile, 2 * i + 1, in_segment);
}

void ViewNeeds::visit_below(ResidentTile& tile, unsigned position, bool in_segment) {
    // Hidden or not: a segment may end here, and the tile says whether it is in view.
    const SplitRecord bound = tile.tile->child_bound[position];
    if (!view_->test(bound)) return;
    if (ResidentTile* const below = tile.below[tile.tile->child_bound.index(position)]) {
        follow(*below);
        visit(*below, 1, in_segment);
    } else {
        miss(LocationCode(tile.root.bits() << tile.tile->depth | position), bound);
    }
}

void ViewNeeds::follow(ResidentTile& tile) {
    if (tile.followed == mark_) return;
    tile.followed = mark_;
    stamp(tile);
    for (ResidentTile* const support : tile.support) hold(*support);
    if (tile.above) follow(*tile.above);
}

// Holds a tile that others depend on, if its root is split: what depends on it is not, otherwise.
void ViewNeeds::hold(ResidentTile& tile) {
    if (tile.held == mark_) return;
    tile.held = mark_;
    if (tile.root.bisection_level() > 0) {
        const TileLayers layers = resident_.layers();
        ResidentTile* const above = tile.tile ? tile.above : resident_.find(layers.above(tile.root));
        if (!above) return hold(layers.above(tile.root));
        const SplitRecord bound = above->tile->child_bound[layers.position(tile.root)];
        if (!view_->test(bound)) return;
        follow(*above);
        if (!tile.tile) return miss(tile.root, bound);
    }
    stamp(tile);
}

void ViewNeeds::stamp(ResidentTile& tile) {
    if (std::exchange(tile.*stamp_, mark_) != mark_) there_.push_back(&tile);
}

// A tile that is not there.
void ViewNeeds::hold(LocationCode root) {
    const TileLayers layers = resident_.layers();
    ResidentTile* const above = resident_.find(layers.above(root));
    if (!above) return hold(layers.above(root));
    const SplitRecord bound = above->tile->child_bound[layers.position(root)];
    if (view_->test(bound)) miss(root, bound);
}

void ViewNeeds::miss(LocationCode root, const SplitRecord& bound) {
    if (!known_missing_.insert(root.bits()).second) return;
    const double nearest = glm::distance(view_->test.eye, centre_of(bound)) - static_cast<double>(bound.radius);
    const double ratio = nearest > 0 ? view_->test.K * static_cast<double>(bound.deviation) / nearest
                                     : std::numeric_limits<double>::infinity();
    missing_.push_back({root, bound.deviation, ratio});
}

bool ViewNeeds::hidden(const SplitRecord& record) const {
    return view_->culling.hidden(centre_of(record), static_cast<double>(record.radius));
}

bool ViewNeeds::ends_patch(const SplitRecord& record, int bisection_level) const {
    const double leg = cell_metrics(bisection_level).split_max * view_->radius_m / std::sqrt(2.0);
    return leg < view_->segment_angle * (glm::distance(view_->test.eye, centre_of(record)) - leg);
}

}  // namespace planet
