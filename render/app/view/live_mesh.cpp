#include "render/app/view/live_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "planet/geodesy/sun.h"
#include "render/app/picture/part_mesh.h"

namespace render {

namespace {

using planet::wgs84;

/// A table takes a tenth of a second of processor time, and in less the air about a moving eye changes little.
constexpr double least_air_interval_s = 0.2;

/// Taken in while the eye moves, at 0.05 ms each a tenth of the frame's time, but enough for frames that take none.
std::size_t tiles_for(double frame_seconds) {
    return static_cast<std::size_t>(std::clamp(frame_seconds * 2000, 64.0, 4096.0));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t detailed_patches(const planet::Segments& segments) {
    std::set<planet::LocationCode> patches;
    for (const planet::Segment& s : segments.segments())
        if (s.detailed) patches.insert(s.patch);
    return patches.size();
}

unsigned threads_beside(const RenderOptions& options) {
    return std::max(1u, options.thread_count() / 2);
}

}  // namespace

LiveMesh::LiveMesh(const RenderOptions& options, const DrawnSurface& surface, std::size_t patch_capacity)
    : options_(options),
      surface_(surface),
      tiles_(surface.field.cache(), {surface.store->metadata().ellipsoid, surface.exaggeration},
             threads_beside(options)),
      patches_(surface.for_patches(), wgs84.mean_radius(), threads_beside(options), patch_capacity) {}

planet::SegmentView LiveMesh::view_of(const Wanted& wanted) const {
    const Camera& camera = wanted.camera;
    planet::SegmentView view = part_view(options_, surface_, camera, {0, 0, camera.width, camera.height},
                                         angle_factor_ * first_segment_angle(camera));
    if (wanted.culling) view.culling = *wanted.culling;
    if (wanted.at_rest) return view;
    view.test.K *= steps_.factor();
    // Up to a pixel nobody sees a vertex come; beyond, it comes slowly.
    view.morph = options_.max_pixel_deviation > steps_.factor();
    return view;
}

bool LiveMesh::step(const Wanted& wanted, bool wait) {
    const auto start = std::chrono::steady_clock::now();
    const auto threads = static_cast<int>(options_.thread_count());
    const bool was_at_rest = std::exchange(at_rest_, wanted.at_rest);
    view_ = view_of(wanted);
    coarsening_ = wanted.at_rest ? 1 : 1 / steps_.factor();
    const bool eye_moved = std::exchange(seen_, view_.culling) != view_.culling || was_at_rest != at_rest_;
    if (eye_moved || !options_.max_triangles) fitted_.reset();
    if (wanted.at_rest && options_.max_triangles) {
        if (!fitted_) fitted_ = planet::fit_triangles(surface_.tiles, view_, *options_.max_triangles, threads);
        view_.test.K = fitted_->K;
        coarsening_ = fitted_->coarsening;
    }
    const planet::SegmentView ahead = planet::view_ahead(view_, wanted.velocity_m_s, 0.5);
    const bool moves = wanted.velocity_m_s != glm::dvec3(0);
    if (wait) segments_.invalidate(tiles_.settle(view_));
    const double since_last = std::chrono::duration<double>(start - std::exchange(updated_, start)).count();
    const auto changes = moves ? tiles_.update(view_, &ahead, tiles_for(since_last)) : tiles_.update(view_);
    segments_.invalidate(changes);
    segments_.update(tiles_, view_, threads);
    bool changed = segments_.built() > 0 || !changes.empty() || eye_moved;
    if (wanted.at_rest) {
        // As many patches as a picture has: coarser ones where there would be too many.
        while (tiles_.residency().pending == 0 && detailed_patches(segments_) > patch_limit &&
               view_.segment_angle * segment_angle_step < largest_segment_angle) {
            angle_factor_ *= segment_angle_step;
            view_ = view_of(wanted);
            segments_.update(tiles_, view_, threads);
            changed = true;
        }
    } else {
        steps_.after_frame(segments_.leaf_count(), wanted.max_triangles);
        if (angle_factor_ > 1 && detailed_patches(segments_) < patch_limit / 4) angle_factor_ = 1;
    }
    update_seconds_ = seconds_since(start);
    return changed;
}

bool LiveMesh::update_patches(bool mesh_changed, std::size_t most) {
    return patches_.update(segments_, mesh_changed, most);
}

void LiveMesh::settle(Wanted wanted) {
    wanted.at_rest = true;
    angle_factor_ = 1;
    update_patches(step(wanted, true), patch_limit);
    while (patches_.missing() > 0) {
        patches_.wait();
        update_patches(false, patch_limit);
    }
}

bool LiveMesh::complete() const {
    return at_rest_ && tiles_.residency().pending == 0 && patches_.missing() == 0;
}

void LiveMesh::place_anew() {
    segments_.invalidate(tiles_.place({surface_.store->metadata().ellipsoid, surface_.exaggeration}));
}

double LiveMesh::pixel_deviation() const {
    const planet::Residency& r = tiles_.residency();
    // Where nothing is missing, the split test itself is the bound: what segments know is for an eye that has moved since.
    const double most = r.pending == 0 && r.damaged == 0 ? 1 : std::numeric_limits<double>::infinity();
    return std::min(std::max(segments_.ratio_max(), r.hidden_ratio), most) * coarsening_ * options_.max_pixel_deviation;
}

double LiveMesh::deviation_m() const {
    return std::max(segments_.deviation_max_m(), tiles_.residency().hidden_deviation_m);
}

std::optional<ViewTable> LiveAir::update(const glm::dvec3& eye, planet::UtcTime time, bool moving) {
    std::optional<ViewTable> ready;
    if (table_.valid() && table_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        ready = table_.get();
        done_ = std::exchange(making_, std::nullopt);
    }
    const Key key{eye, time};
    const double since = seconds_since(begun_);
    if (!making_ && done_ != key && (!moving || since > least_air_interval_s)) {
        making_ = key;
        begun_ = std::chrono::steady_clock::now();
        table_ = std::async(std::launch::async, [this, key] {
            return make_view_table(tables_, key.eye, planet::sun_direction(key.time), threads_);
        });
    }
    return ready;
}

}  // namespace render
