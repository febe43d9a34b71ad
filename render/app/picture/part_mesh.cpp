#include "render/app/picture/part_mesh.h"

#include <algorithm>
#include <set>

#include "planet/mesh/budget.h"

namespace render {

namespace {

using planet::wgs84;

/// The most lattice steps of a patch are this many pixels: one normal a pixel or more, as far as there is data.
constexpr double patch_pixels = 96;
/// A patch of this many bisection levels above the finest has two texels between the vertices of the surface.
constexpr int finest_patch_above = 10;

std::size_t detailed_patches(const planet::Segments& segments) {
    std::set<planet::LocationCode> patches;
    for (const planet::Segment& s : segments.segments())
        if (s.detailed) patches.insert(s.patch);
    return patches.size();
}

}  // namespace

planet::SegmentView part_view(const RenderOptions& options, const DrawnSurface& surface, const Camera& camera,
                              const PicturePart& part, double segment_angle) {
    planet::SegmentView view;
    view.test = {camera.eye, planet::split_reach(camera.focal_px, camera.tan_corner(), options.max_pixel_deviation)};
    view.culling = camera.culling(part, surface.occluder_radius());
    view.radius_m = wgs84.mean_radius();
    view.finest_patch_level = std::max(surface.store->metadata().finest_level - finest_patch_above, 0);
    view.segment_angle = segment_angle;
    return view;
}

double first_segment_angle(const Camera& camera) {
    return patch_pixels / camera.focal_px;
}

void PartMesher::take_tiles() {
    if (tiles_) loaded_before_ += tiles_->count();
    tiles_.emplace(surface_.field.cache(),
                   planet::Placement{surface_.store->metadata().ellipsoid, surface_.exaggeration});
}

bool PartMesher::build(const PicturePart& part, Crowd crowd, PartMesh& mesh) {
    if (surface_.field.cache().memory_bytes() > surface_.field.cache().memory_limit_bytes()) take_tiles();
    double segment_angle = first_segment_angle(camera_), coarsening = 1;
    for (bool crowded = true; crowded; segment_angle *= segment_angle_step) {
        mesh.view = part_view(options_, surface_, camera_, part, segment_angle);
        steps_.time("mesh", [&] {
            const Fineness fine = fineness(segment_angle);
            mesh.view.test.K = fine.K;
            coarsening = fine.coarsening;
            build_segments(mesh);
        });
        crowded =
            detailed_patches(mesh.segments) > patch_limit && segment_angle * segment_angle_step < largest_segment_angle;
        if (crowded && crowd == Crowd::refused) return false;
    }
    certify(mesh, coarsening);
    steps_.time("normals", [&] {
        mesh.patches.build(mesh.segments, surface_.for_patches(), wgs84.mean_radius(),
                           static_cast<int>(options_.thread_count()));
    });
    return true;
}

// A budget is the whole picture's, so that its parts fit together.
PartMesher::Fineness PartMesher::fineness(double segment_angle) {
    const planet::SegmentView whole =
        part_view(options_, surface_, camera_, {0, 0, camera_.width, camera_.height}, segment_angle);
    if (!options_.max_triangles) return {whole.test.K, 1};
    const auto [known, is_new] = fineness_.try_emplace(segment_angle);
    if (is_new) {
        const planet::TriangleBudget budget =
            planet::fit_triangles(*tiles_, whole, *options_.max_triangles, static_cast<int>(options_.thread_count()));
        known->second = {budget.K, budget.coarsening};
    }
    return known->second;
}

void PartMesher::build_segments(PartMesh& mesh) {
    const auto threads = static_cast<int>(options_.thread_count());
    if (!around_damage_) {
        mesh.segments.build(*tiles_, mesh.view, threads);
        if (surface_.field.cache().damage().empty()) return;
        const planet::Placement placement{surface_.store->metadata().ellipsoid, surface_.exaggeration};
        around_damage_ =
            std::make_unique<planet::ResidentTiles>(surface_.field.cache(), placement, static_cast<unsigned>(threads));
    }
    around_damage_->settle(mesh.view);
    mesh.segments.build(*around_damage_, mesh.view, threads);
}

void PartMesher::certify(PartMesh& mesh, double coarsening) const {
    double deviation = mesh.segments.deviation_max_m(), ratio = mesh.segments.ratio_max();
    if (around_damage_) {
        deviation = std::max(deviation, around_damage_->residency().hidden_deviation_m);
        ratio = std::max(ratio, around_damage_->residency().hidden_ratio);
    }
    mesh.deviation_max_m = deviation;
    mesh.pixel_deviation_max = ratio * coarsening * options_.max_pixel_deviation;
}

const planet::TileSource& PartMesher::tiles() const {
    if (around_damage_) return *around_damage_;
    return *tiles_;
}

planet::ResidentCounts PartMesher::counts() const {
    if (around_damage_) return around_damage_->counts();
    const planet::TileCache& cache = surface_.field.cache();
    return {.tiles = tiles_->count(),
            .tile_bytes = tiles_->bytes(),
            .tiles_loaded = loaded_before_ + tiles_->count(),
            .memory_limit_bytes = cache.memory_limit_bytes(),
            .memory_peak_bytes = cache.memory_peak_bytes()};
}

}  // namespace render
