#pragma once
// What lies on the terrain: the mesh itself (sides, the Sierpinski curve, colours by level, segment or deviation) and the
// graticule.

#include "planet/mesh/segments.h"
#include "render/gl/buffer.h"
#include "render/gl/shader.h"
#include "render/picture/camera.h"

namespace render {

class OverlayPass {
  public:
    struct Show {
        bool mesh = false, levels = false, curve = false, segments = false, deviations = false, graticule = false;
        bool any() const { return mesh || levels || curve || segments || deviations || graticule; }
    };

    explicit OverlayPass(Show show);

    /// Three vertices a triangle: 60 bytes each triangle. @param tiles what the segments were built from
    void upload(const planet::Segments& segments, const planet::TileSource& tiles);

    /// Blends over the terrain, which must have been drawn with the same camera.
    /// @param pixel_scale of widths: below 1 where the picture is shown larger
    void draw(const Camera& camera, const PicturePart& part, double pixel_scale);

  private:
    Show show_;
    Program program_;
    VertexArray array_;
    Buffer vertices_;
    GLsizei count_ = 0;
};

}  // namespace render
