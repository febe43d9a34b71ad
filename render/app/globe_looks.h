#pragma once
// What a globe is drawn with: the cube maps, the ground, the sky, and what shows the mesh. Pictures and the viewer share
// it, which is why a settled view and the picture of its command line have the same pixels.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "planet/geodesy/utc_time.h"
#include "render/app/imagery.h"
#include "render/app/render_options.h"
#include "render/gl/texture.h"
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
    void set_overlay(OverlayPass::Show show) { overlay_.emplace(show); }

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
        double morph_reach = 0;  ///< see TerrainLook
    };
    /// Draws the meshes of terrain() and overlay() into what is bound.
    void draw(const Frame& frame) {
        draw_opaque(frame);
        draw_blended(frame);
    }
    /// Ground and sky, as often over each other as may be; then, once, what blends over them.
    void draw_opaque(const Frame& frame);
    void draw_blended(const Frame& frame);

    TerrainPass& terrain() { return *terrain_; }
    OverlayPass& overlay() { return *overlay_; }

  private:
    Texture day_, night_, relief_;
    double texel_m_ = 0;
    SkyUniforms air_{};
    std::optional<TerrainPass> terrain_;
    std::optional<SkyPass> sky_;
    std::optional<OverlayPass> overlay_;
};

}  // namespace render
