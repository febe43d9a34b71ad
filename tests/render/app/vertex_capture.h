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
    /// @param defines of the vertex shader
    explicit VertexCapture(std::vector<std::string> defines = {})
        : program_(Program::link({"terrain.vert.glsl"},
                                 {.defines = std::move(defines), .feedback_varyings = {"view", "gl_Position"}})) {}

    /// With MORPH: K of the split test.
    void set_morph_reach(double reach) { program_.set("morph_reach", static_cast<float>(reach)); }

    /// All vertices, as CapturedVertex or its bits.
    template <class Vertex = CapturedVertex>
    std::vector<Vertex> decode(std::span<const planet::SegmentVertex> vertices, const Camera& camera) {
        return decode<Vertex>(SegmentBuffers(vertices, {}), vertices.size(), camera);
    }
    template <class Vertex = CapturedVertex>
    std::vector<Vertex> decode(const SegmentBuffers& buffers, std::size_t count, const Camera& camera) {
        const Buffer output(count * sizeof(Vertex), 0);
        target_.bind();
        program_.use();
        set_grid_camera(program_, camera, {0, 0, camera.width, camera.height});
        buffers.bind();
        output.bind_base(GL_TRANSFORM_FEEDBACK_BUFFER, 0);
        gl().Enable(GL_RASTERIZER_DISCARD);
        gl().BeginTransformFeedback(GL_POINTS);
        gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
        gl().EndTransformFeedback();
        gl().Disable(GL_RASTERIZER_DISCARD);
        return output.download<Vertex>(count);
    }

  private:
    Program program_;
    Framebuffer target_{1, 1};  // without any display there is no other
};

}  // namespace render::testing
