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

/// A longer step than that is a beginning: nothing is known of a motion.
constexpr double longest_step_s = 1;

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
    const bool prepared = mesh_ahead_.finish();
    const bool was_at_rest = std::exchange(at_rest_, wanted.at_rest);
    view_before_ = std::exchange(view_, view_of(wanted));
    frame_seconds_ = std::chrono::duration<double>(start - std::exchange(updated_, start)).count();
    goes_on_ = !wanted.at_rest && !was_at_rest && frame_seconds_ < longest_step_s;
    velocity_m_s_ = wanted.velocity_m_s;
    if (goes_on_ && velocity_m_s_ == glm::dvec3(0))
        velocity_m_s_ = (view_.test.eye - view_before_.test.eye) / frame_seconds_;
    coarsening_ = wanted.at_rest ? 1 : 1 / steps_.factor();
    const bool eye_moved = std::exchange(seen_, view_.culling) != view_.culling || was_at_rest != at_rest_;
    if (eye_moved || !options_.max_triangles) fitted_.reset();
    if (wanted.at_rest && options_.max_triangles) {
        if (!fitted_) fitted_ = planet::fit_triangles(surface_.tiles, view_, *options_.max_triangles, threads);
        view_.test.K = fitted_->K;
        coarsening_ = fitted_->coarsening;
    }
    if (wait) segments_.invalidate(tiles_.settle(view_));
    const auto ahead = view_ahead(view_);
    const auto changes = tiles_.update(view_, ahead ? &*ahead : nullptr, prepared ? 0 : most_tiles());
    segments_.invalidate(changes);
    segments_.update(tiles_, view_, threads);
    bool changed = segments_.built() > 0 || !changes.empty() || prepared || eye_moved;
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
    residency_ = tiles_.residency();
    counts_ = tiles_.counts();
    update_seconds_ = seconds_since(start);
    return changed;
}

std::optional<planet::SegmentView> LiveMesh::view_ahead(const planet::SegmentView& view) const {
    constexpr double seconds = 0.5;
    if (velocity_m_s_ == glm::dvec3(0)) return std::nullopt;
    return planet::view_ahead(view, velocity_m_s_, seconds);
}

std::size_t LiveMesh::most_tiles() const {
    return velocity_m_s_ == glm::dvec3(0) ? planet::ResidentTiles::unlimited : tiles_for(frame_seconds_);
}

void LiveMesh::make_next() {
    if (!goes_on_ || (velocity_m_s_ == glm::dvec3(0) && view_.culling == view_before_.culling)) return;
    begin_next(planet::view_after(view_before_, view_));
}

void LiveMesh::make_next(const Camera& camera) {
    // How fine a budget allows it to be is known only once all of its tiles are there.
    if (!options_.max_triangles) begin_next(view_of({.camera = camera, .at_rest = true}));
}

void LiveMesh::begin_next(const planet::SegmentView& next) {
    mesh_ahead_.begin(next, view_ahead(next), most_tiles(), static_cast<int>(threads_beside(options_)));
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
    return at_rest_ && residency_.pending == 0 && patches_.missing() == 0;
}

void LiveMesh::place_anew() {
    mesh_ahead_.finish();
    segments_.invalidate(tiles_.place({surface_.store->metadata().ellipsoid, surface_.exaggeration}));
}

double LiveMesh::pixel_deviation() const {
    const planet::Residency& r = residency_;
    // Where nothing is missing, the split test itself is the bound: what segments know is for an eye that has moved since.
    const double most = r.pending == 0 && r.damaged == 0 ? 1 : std::numeric_limits<double>::infinity();
    return std::min(std::max(segments_.ratio_max(), r.hidden_ratio), most) * coarsening_ * options_.max_pixel_deviation;
}

double LiveMesh::deviation_m() const {
    return std::max(segments_.deviation_max_m(), residency_.hidden_deviation_m);
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
