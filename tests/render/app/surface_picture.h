#pragma once
// Pictures of where things are rather than of how they look: a number or a position for each pixel.

#include <string>
#include <vector>

#include "planet/geodesy/ellipsoid.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/passes/terrain.h"

namespace render::testing {

/// What lies in the middle of a pixel, nearest to the eye.
class SurfacePicture {
  public:
    SurfacePicture(int width, int height, GLenum color_format)
        : target_(width, height, {.color_format = color_format}) {}

    /// The position from the eye, m, three floats and 1 a pixel, or four 0 for the sky; for GL_RGBA32F.
    template <class Draw>
    std::vector<float> positions(const Camera& camera, Draw draw) {
        return picture(camera, positions_, 0, draw);
    }
    /// How far away it is along the planet: the tangent of the angle at the planet's centre to what is below the eye, in
    /// metres at the eye's distance; 1e30 for the sky. Points of the surface that move up or down keep it. For GL_R32F.
    template <class Draw>
    std::vector<float> ranges(const Camera& camera, Draw draw) {
        const planet::NormalPosition eye = planet::position_from_ecef(planet::wgs84, camera.eye);
        ranges_.set("up", glm::vec3(eye.normal));
        ranges_.set("to_centre", static_cast<float>(eye.h.m + planet::wgs84.mean_radius()));
        std::vector<float> rgba = picture(camera, ranges_, 1e30f, draw);
        for (std::size_t i = 0; i < rgba.size() / 4; ++i) rgba[i] = rgba[4 * i];
        rgba.resize(rgba.size() / 4);
        return rgba;
    }
    /// Depth, 0 for the sky.
    template <class Draw>
    std::vector<float> depths(const Camera& camera, Draw draw) {
        draw_picture(camera, positions_, 0, draw);
        return target_.read_depth();
    }

  private:
    template <class Draw>
    std::vector<float> picture(const Camera& camera, Program& program, float sky, Draw draw) {
        draw_picture(camera, program, sky, draw);
        return target_.read_rgba_float();
    }
    template <class Draw>
    void draw_picture(const Camera& camera, Program& program, float sky, Draw draw) {
        target_.bind();
        target_.clear(sky, 0, 0, 0);
        program.use();
        set_grid_camera(program, camera, {0, 0, camera.width, camera.height});
        gl().Enable(GL_DEPTH_TEST);
        gl().DepthFunc(GL_GREATER);
        gl().Enable(GL_CULL_FACE);
        draw();
        gl().Disable(GL_CULL_FACE);
    }
    static std::optional<std::string_view> source(std::string_view name) {
        if (name == "position.frag.glsl")
            return "#version 450 core\nin vec3 view;\nout vec4 position;\nvoid main() { position = vec4(view, 1.0); "
                   "}\n";
        if (name == "range.frag.glsl")
            return "#version 450 core\nin vec3 view;\nuniform vec3 up;\nuniform float to_centre;\nout float range;\n"
                   "void main() {\n"
                   "    float height = dot(view, up);\n"
                   "    range = length(view - height * up) / (1.0 + height / to_centre);\n"
                   "}\n";
        return find_shader_source(name);
    }

    Program positions_ = Program::link({"terrain.vert.glsl", "position.frag.glsl"}, {.find = source});
    Program ranges_ = Program::link({"terrain.vert.glsl", "range.frag.glsl"}, {.find = source});
    Framebuffer target_;
};

}  // namespace render::testing
