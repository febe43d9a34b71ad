#include "render/app/picture/globe_looks.h"

#include <algorithm>

#include "planet/error.h"
#include "planet/geodesy/earth_rotation.h"
#include "planet/geodesy/geodetic.h"
#include "render/gl/checks.h"
#include "render/layers/graticule.h"
#include "render/picture/relief_patches.h"

namespace render {

namespace {

using planet::wgs84;

constexpr double highest_ground_m = 9000;

}  // namespace

OverlayPass::Show overlays_of(const RenderOptions& o) {
    return {.mesh = o.shows(Overlay::mesh),
            .levels = o.shows(Overlay::levels),
            .curve = o.shows(Overlay::curve),
            .segments = o.shows(Overlay::segments),
            .deviations = o.shows(Overlay::deviations),
            .graticule = o.shows(Overlay::graticule)};
}

void GlobeLooks::upload(const Imagery& imagery) {
    day_ = upload_cube(imagery.day, GL_SRGB8_ALPHA8);
    night_ = upload_cube(imagery.night, GL_SRGB8_ALPHA8);
    relief_ = upload_cube(imagery.relief, GL_RGBA8_SNORM);
    texel_m_ = imagery.texel_m(wgs84.mean_radius());
}

void GlobeLooks::link(std::span<const Star> stars, std::span<const std::vector<std::uint8_t>> noise,
                      OverlayPass::Show show) {
    terrain_.emplace();
    sky_.emplace(stars, noise);
    set_overlay(show);
}

void GlobeLooks::set_overlay(OverlayPass::Show show) {
    overlay_.emplace(show);
    graticule_ = show.graticule;
    if (!graticule_ || label_pass_) return;
    try {
        label_pass_.emplace();
    } catch (const planet::Error&) {  // no font: nobody has asked for names, and lines are lines without
    }
}

void GlobeLooks::set_layers(std::vector<const Layer*> layers, bool stencil) {
    stencil_ = stencil;
    layers_ = std::move(layers);
    if (!layers_.empty() && !layer_pass_) layer_pass_.emplace();
    const bool meshes = std::ranges::any_of(layers_, [](const Layer* layer) { return layer->mesh.has_value(); });
    if (meshes && !mesh_pass_) mesh_pass_.emplace();
    const bool names = std::ranges::any_of(layers_, [](const Layer* layer) { return !layer->names.empty(); });
    if (names && !label_pass_) label_pass_.emplace();
}

void GlobeLooks::set_sky(const AtmosphereTables& tables, ViewTable view, planet::UtcTime time) {
    view.uniforms.sky_detail.w = static_cast<float>(texel_m_);
    air_ = view.uniforms;
    sky_->set_view(tables, view, glm::mat3(planet::ecef_from_j2000(time)));
}

bool GlobeLooks::from_afar(const Camera& camera, double exaggeration) const {
    // The least ground distance and the smallest pixel there can be, at a corner.
    const double clearance = planet::height_from_ecef(wgs84, camera.eye).m - highest_ground_m * exaggeration;
    const double pixel_angle = 1 / (camera.focal_px * (1 + camera.tan_corner() * camera.tan_corner()));
    return !needs_close_up(air_, std::max(clearance, 0.0), pixel_angle);
}

TerrainLook GlobeLooks::look_of(const Frame& frame) const {
    constexpr double stretch = (wgs84.a / wgs84.b) * (wgs84.a / wgs84.b);
    return {.exaggeration = frame.exaggeration,
            .polar_stretch = stretch,
            .patch_range = patch_range,
            .from_afar = frame.relief || from_afar(frame.camera, frame.exaggeration),
            .relief = frame.relief,
            .morph_reach = frame.morph_reach};
}

void GlobeLooks::draw_opaque(const Frame& frame) {
    sky_->bind(frame.camera, frame.part);
    day_.bind(4);
    night_.bind(5);
    relief_.bind(6);
    frame.patches.bind(7);
    terrain_->draw(frame.camera, frame.part, look_of(frame));
    sky_->draw_air(frame.camera, frame.part);
}

void GlobeLooks::draw_blended(const Frame& frame, const Framebuffer& target) {
    sky_->bind(frame.camera, frame.part);
    overlay_->draw(frame.camera, frame.part, frame.pixel_scale);
    sky_->draw_stars(frame.camera, frame.part);
    draw_layers(frame, target);
    if (frame.labels) draw_labels(frame.camera, frame.part, frame.ground, frame.pixel_scale);
}

// In runs of meshes, and of lines and polygons.
void GlobeLooks::draw_layers(const Frame& frame, const Framebuffer& target) {
    const Texture* terrain_depth = nullptr;
    for (auto first = layers_.begin(); first != layers_.end();) {
        const bool meshes = (*first)->mesh.has_value();
        const auto last =
            std::find_if(first, layers_.end(), [&](const Layer* layer) { return layer->mesh.has_value() != meshes; });
        const std::span<const Layer* const> run(first, last);
        first = last;
        if (!meshes) {
            layer_pass_->draw(run, {.camera = frame.camera,
                                    .part = frame.part,
                                    .pixel_scale = frame.pixel_scale,
                                    .ground = frame.ground,
                                    .target = target,
                                    .terrain_depth = terrain_depth,
                                    .mesh_lift_m = mesh_lift_m(frame.exaggeration)});
            continue;
        }
        if (terrain_depth == nullptr && last != layers_.end()) terrain_depth = &keep_terrain_depth(target);
        sky_->bind(frame.camera, frame.part);
        mesh_pass_->draw(run, frame.camera, frame.part, look_of(frame));
    }
}

const Texture& GlobeLooks::keep_terrain_depth(const Framebuffer& target) {
    target.resolve_depth();
    const Texture& depth = target.depth();
    if (terrain_depth_.width() != depth.width() || terrain_depth_.height() != depth.height()) {
        terrain_depth_ = Texture();  // before another takes memory
        terrain_depth_ = Texture::make_2d(depth.internal_format(), depth.width(), depth.height());
    }
    gl().CopyImageSubData(depth.name(), GL_TEXTURE_2D, 0, 0, 0, 0, terrain_depth_.name(), GL_TEXTURE_2D, 0, 0, 0, 0,
                          depth.width(), depth.height(), 1);
    check_gl("GlobeLooks::keep_terrain_depth");
    return terrain_depth_;
}

void GlobeLooks::draw_labels(const Camera& camera, const PicturePart& part, const DrapeGround& ground,
                             double pixel_scale) {
    if (!label_pass_) return;
    std::vector<const Layer*> named = layers_;
    if (graticule_) {
        graticule_names_.names = graticule_names(camera, graticule_step(camera, pixel_scale));
        named.insert(named.begin(), &graticule_names_);
    }
    label_pass_->draw(named, camera, part, ground, pixel_scale);
}

}  // namespace render
