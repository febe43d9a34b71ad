#pragma once
// What the vertex shader of pictures makes of vertices, by transform feedback.

#include <vector>

#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "tests/render/app/segment_triangles.h"

namespace render::testing {

struct CapturedVertex {
    glm::vec3 view;  ///< from the eye, ecef, m
    glm::vec4 clip;  ///< gl_Position
};
static_assert(sizeof(CapturedVertex) == 28);

class VertexCapture {
  public:
    /// All vertices, as CapturedVertex or its bits.
    template <class Vertex = CapturedVertex>
    std::vector<Vertex> decode(std::span<const planet::SegmentVertex> vertices, const Camera& camera) {
        const SegmentBuffers buffers(vertices, {});
        const Buffer output(vertices.size() * sizeof(Vertex), 0);
        target_.bind();
        program_.use();
        set_grid_camera(program_, camera, {0, 0, camera.width, camera.height});
        buffers.bind();
        output.bind_base(GL_TRANSFORM_FEEDBACK_BUFFER, 0);
        gl().Enable(GL_RASTERIZER_DISCARD);
        gl().BeginTransformFeedback(GL_POINTS);
        gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(vertices.size()));
        gl().EndTransformFeedback();
        gl().Disable(GL_RASTERIZER_DISCARD);
        return output.download<Vertex>(vertices.size());
    }

  private:
    Program program_ = Program::link({"terrain.vert.glsl"}, {.feedback_varyings = {"view", "gl_Position"}});
    Framebuffer target_{1, 1};  // without any display there is no other
};

}  // namespace render::testing
