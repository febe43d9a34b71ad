#pragma once
// The mesh itself as a picture: sides, levels in colour, the Sierpinski curve.

#include "planet/mesh/segments.h"
#include "render/gl/buffer.h"
#include "render/gl/shader.h"
#include "render/picture/camera.h"

namespace render {

class OverlayPass {
  public:
    struct Show {
        bool mesh = false, levels = false, curve = false;
        bool any() const { return mesh || levels || curve; }
    };

    explicit OverlayPass(Show show);

    /// Three vertices a triangle: 60 bytes each triangle.
    void upload(const planet::Segments& segments);

    /// Blends over the terrain, which must have been drawn with the same camera.
    void draw(const Camera& camera, const PicturePart& part);

  private:
    Show show_;
    Program program_;
    VertexArray array_;
    Buffer vertices_;
    GLsizei count_ = 0;
};

}  // namespace render
