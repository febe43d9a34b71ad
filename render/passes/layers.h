#pragma once
// Layers over the terrain: filled polygons, lines and points, of constant width, in the order given.

#include <span>
#include <vector>

#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/layers/draped_lines.h"
#include "render/layers/layer.h"

namespace render {

class LayerPass {
  public:
    /// Farther from a pixel no depth is asked for, at a pixel_scale of 1: half of the largest mark, with its rim.
    static constexpr int reach_px = 40;

    /// With the context that is current.
    LayerPass();

    struct View {
        const Camera& camera;  ///< of the whole picture
        PicturePart part;
        double pixel_scale = 1;  ///< of widths: below 1 where a picture is drawn smaller than it is shown, above where
                                 ///< the pixels of a display are small
        DrapeGround& ground;
        const Framebuffer& target;  ///< bound, with the terrain's depth, and a stencil
        /// Of the target before meshes were drawn; null: none was.
        const Texture* terrain_depth = nullptr;
        double mesh_lift_m = 0;  ///< what such a mesh may be in front of a line on the terrain and not hide it
    };
    /// Leaves the target's alpha at 1.
    void draw(std::span<const Layer* const> layers, const View& view);

  private:
    /// Draped lines on the GPU.
    struct Pieces {
        Buffer buffer;
        VertexArray array;
        GLsizei count = 0;
    };
    void draw(const Layer& layer, const View& view);
    static Pieces drape(const GeodesicLines& lines, const View& view);
    void cover(const Pieces& pieces, double half_width, double opacity, const View& view);
    void fill(const FilledPolygons& polygons, double opacity, const View& view);
    static void begin_alpha(float alpha);
    void blend(const glm::vec3& color);
    void paint(const glm::vec4& color);

    Program line_, wall_, paint_;
    VertexArray nothing_;
};

}  // namespace render
