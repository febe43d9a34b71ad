#pragma once
// The signed number of surfaces that a pixel's ray crosses: +1 where it enters the planet, -1 where it leaves it.
//
// The planet is closed, so every ray from an eye outside crosses it 0 times in sum, and from inside -1. A hole, an
// overlap or a T-junction that a ray meets changes the sum, in front of the sky, of the ground or of anything else.
// Nothing may be culled: not by segments, faces, or depth.
//
//     eye ->  ---+1---[ hill ]---(-1)--------+1---[ planet ]---(-1)---> sky      sum 0
//
// What the near plane cuts off lies within 2 cm sqrt(1 + tan^2 corner) of the eye or behind it: it belongs to no ray.

#include <string>
#include <vector>

#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/passes/terrain.h"

namespace render::testing {

class CrossingCount {
  public:
    /// @param defines of the vertex shader
    CrossingCount(int width, int height, std::vector<std::string> defines = {})
        : program_(Program::link({"terrain.vert.glsl", "crossing.frag.glsl"},
                                 {.defines = std::move(defines), .find = source})),
          target_(width, height, {.color_format = GL_R32F, .depth = false}) {}

    /// With MORPH: K of the split test.
    void set_morph_reach(double reach) { program_.set("morph_reach", static_cast<float>(reach)); }

    /// @param draw draws the whole planet with the program in use @return by pixel, the top row first
    template <class Draw>
    std::vector<int> count(const Camera& camera, Draw draw) {
        target_.bind();
        target_.clear(0, 0, 0, 0);
        program_.use();
        set_grid_camera(program_, camera, {0, 0, camera.width, camera.height});
        gl().Disable(GL_DEPTH_TEST);
        gl().Disable(GL_CULL_FACE);
        gl().Enable(GL_BLEND);
        gl().BlendFunc(GL_ONE, GL_ONE);
        draw();
        gl().Disable(GL_BLEND);
        gl().Enable(GL_DEPTH_TEST);
        const std::vector<float> rgba = target_.read_rgba_float();
        std::vector<int> sum(rgba.size() / 4);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = static_cast<int>(rgba[4 * i]);
        return sum;
    }

  private:
    static std::optional<std::string_view> source(std::string_view name) {
        if (name == "crossing.frag.glsl")
            return "#version 450 core\nout float crossing;\n"
                   "void main() { crossing = gl_FrontFacing ? 1.0 : -1.0; }\n";
        return find_shader_source(name);
    }
    Program program_;
    Framebuffer target_;
};

}  // namespace render::testing
