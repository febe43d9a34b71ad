#pragma once
// What a globe is drawn with: the cube maps, the ground, the sky, and what shows the mesh. Pictures and the viewer share
// it, which is why a settled view and the picture of its command line have the same pixels.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "planet/geodesy/utc_time.h"
#include "render/app/picture/imagery.h"
#include "render/app/picture/render_options.h"
#include "render/gl/texture.h"
#include "render/passes/labels.h"
#include "render/passes/layer_meshes.h"
#include "render/passes/layers.h"
#include "render/passes/overlay.h"
#include "render/passes/sky.h"
#include "render/passes/terrain.h"

namespace render {

/// What of the overlays in the options is to be drawn.
OverlayPass::Show overlays_of(const RenderOptions& options);

class GlobeLooks {
  public:
    /// The context's functions from here on.
    void upload(const Imagery& imagery);
    void link(std::span<const Star> stars, std::span<const std::vector<std::uint8_t>> noise, OverlayPass::Show show);
    /// The air about an eye. @param view of make_view_table()
    void set_sky(const AtmosphereTables& tables, ViewTable view, planet::UtcTime time);
    /// What lies over the terrain, the lowest first. All stay as long as this. @param stencil whether
    /// there may ever be polygons or meshes
    void set_layers(std::vector<const Layer*> layers, bool stencil);
    /// Of what is to be drawn into.
    Framebuffer::Options target_options(int samples) const {
        return {.color_format = GL_RGBA8, .samples = samples, .stencil = stencil_};
    }
    void set_overlay(OverlayPass::Show show);

    /// Whether a camera can only see ground as coarse as the imagery: such pictures need one sample a pixel.
    bool from_afar(const Camera& camera, double exaggeration) const;

    /// Of a pixel: what the options say, or what the view needs. @param most of the context
    int samples(const RenderOptions& options, const Camera& camera, int most) const {
        if (options.samples > 0) return options.samples;
        return from_afar(camera, options.exaggeration) ? 1 : std::min(4, most);
    }

    struct Frame {
        const Camera& camera;
        PicturePart part;
        double exaggeration = 1;
        const Texture& patches;
        DrapeGround& ground;     ///< what layers lie on
        double morph_reach = 0;  ///< see TerrainLook
        bool relief = false;     ///< heights as colours instead of the imagery
        double pixel_scale = 1;  ///< of widths: that of the options, times what is drawn of the pixels that are shown
        bool labels = true;
    };
    /// Draws the meshes of terrain() and overlay(), and layers, into what is bound: the target.
    void draw(const Frame& frame, const Framebuffer& target) {
        draw_opaque(frame);
        draw_blended(frame, target);
    }
    /// Ground and sky, as often over each other as may be; then, once, what blends over them.
    void draw_opaque(const Frame& frame);
    void draw_blended(const Frame& frame, const Framebuffer& target);
    /// Names of layers, and of the graticule's lines, into what is bound.
    void draw_labels(const Camera& camera, const PicturePart& part, const DrapeGround& ground, double pixel_scale);

    TerrainPass& terrain() { return *terrain_; }
    OverlayPass& overlay() { return *overlay_; }

  private:
    TerrainLook look_of(const Frame& frame) const;
    void draw_layers(const Frame& frame, const Framebuffer& target);
    const Texture& keep_terrain_depth(const Framebuffer& target);

    Texture day_, night_, relief_;
    double texel_m_ = 0;
    SkyUniforms air_{};
    std::optional<TerrainPass> terrain_;
    std::optional<SkyPass> sky_;
    std::optional<OverlayPass> overlay_;
    std::vector<const Layer*> layers_;
    Texture terrain_depth_;  ///< before meshes were drawn, if lines are drawn after them
    bool stencil_ = false, graticule_ = false;
    Layer graticule_names_;                   ///< of the view that was drawn last
    std::optional<LayerPass> layer_pass_;     // once there are layers
    std::optional<LayerMeshPass> mesh_pass_;  // once there are meshes
    std::optional<LabelPass> label_pass_;     // once there are names
};

}  // namespace render
