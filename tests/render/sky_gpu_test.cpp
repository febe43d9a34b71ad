// The shaders on the GPU against the same text on the CPU.
#include <gtest/gtest.h>

#include <random>

#include "planet/frames.h"
#include "render/gl/buffer.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/sky/cube_map.h"
#include "render/sky/shading_reference.h"
#include "render/sky/stars.h"

namespace render {
namespace {

using glm::dvec3;
using glm::vec3;

Texture texture_of(const TableImage& image) {
    Texture t = image.depth > 1 ? Texture::make_3d(GL_RGBA32F, image.width, image.height, image.depth)
                                : Texture::make_2d(GL_RGBA32F, image.width, image.height);
    t.upload(0, bytes_of(image.texels));
    return t;
}

/// Draws one triangle with a fragment shader of our own over a picture of floats.
constexpr std::string_view probe = R"(#version 450 core
#include "atmosphere.glsl"
#include "sky.glsl"
#include "surface.glsl"
#include "tonemap.glsl"
layout(binding = 7) uniform sampler2D inputs;
layout(location = 0) out vec4 color;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 a = texelFetch(inputs, ivec2(0, at.x), 0);
    vec4 b = texelFetch(inputs, ivec2(1, at.x), 0);
    SurfaceInput s;
    s.view = a.xyz * a.w;
    s.normal = b.xyz;
    s.terrain_normal = normalize(b.xyz + vec3(0.1, -0.2, 0.1));
    s.imagery = abs(b.zxy) * 0.4;
    s.night = vec3(0.3);
    s.water = fract(b.w * 7.0);
    s.height = b.w * 3000.0;
    s.footprint = 30000.0;
    if (at.y == 0) color = vec4(sky_radiance(a.xyz, sun_through_air()), 1);
    if (at.y == 1) color = vec4(aerial(surface_radiance(s), s.view), 1);
    if (at.y == 2) color = vec4(display_from_radiance(b.www * 2.0, vec2(at) + 0.5), 1);
}
)";

TEST(SkyGpu, SameNumbersAsOnTheProcessor) {
    auto context = Context::create();
    const AtmosphereTables tables = make_tables();
    const int n = 1000;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(-1, 1);
    ProgramOptions options;
    options.find = [](std::string_view name) -> std::optional<std::string_view> {
        return name == "probe.frag.glsl" ? std::optional(probe) : find_shader_source(name);
    };
    const Program program = Program::link({"full_screen.vert.glsl", "probe.frag.glsl"}, options);
    const auto noise = make_noise_volume(16);
    Texture volume = Texture::make_3d(GL_RGBA8, 16, 16, 16);
    volume.upload(0, bytes_of(noise));
    for (const double h : {2.0, 12e3, 4e5, 3e7}) {
        const ViewTable view = make_view_table(tables, {0, 6378137.0 + h, 0}, glm::normalize(dvec3(0.3, 0.4, 0.5)));
        reference::Shading cpu(view.uniforms, tables, view);
        cpu.noise_table = {noise.data(), 16};
        std::vector<glm::vec4> inputs;
        for (int i = 0; i < n; ++i) {
            vec3 d = glm::normalize(vec3(uniform(random), uniform(random), uniform(random)));
            if (h > 1e5) d = glm::normalize(d * 6.4e6f - vec3(0, 6378137.0 + h, 0));
            const float far = static_cast<float>(std::pow(10, 4 + 3 * std::abs(uniform(random))));
            inputs.emplace_back(d, far);
            inputs.emplace_back(glm::normalize(vec3(uniform(random), uniform(random), uniform(random))),
                                std::abs(uniform(random)));
        }
        Texture in = Texture::make_2d(GL_RGBA32F, 2, n);
        in.upload(0, bytes_of(inputs));
        in.set_sampling({GL_NEAREST, GL_NEAREST});
        const Texture air = texture_of(view.air), sun = texture_of(tables.sun_light),
                      sky = texture_of(tables.sky_light);
        const Buffer block(std::as_bytes(std::span(&view.uniforms, 1)));
        block.bind_base(GL_UNIFORM_BUFFER, 1);
        air.bind(0), sun.bind(1), sky.bind(2), volume.bind(3), in.bind(7);
        const Framebuffer target(n, 3, {.color_format = GL_RGBA32F, .depth = false});
        target.bind();
        const VertexArray none = VertexArray::create();
        none.bind();
        program.use();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        const std::vector<float> out = target.read_rgba_float();
        const vec3 through = cpu.sun_through_air();
        int worse[3] = {};
        for (int i = 0; i < n; ++i) {
            const glm::vec4 a = inputs[static_cast<std::size_t>(2 * i)],
                            b = inputs[static_cast<std::size_t>(2 * i + 1)];
            reference::Shading::SurfaceInput s;
            s.view = vec3(a) * a.w;
            s.normal = vec3(b);
            s.terrain_normal = glm::normalize(vec3(b) + vec3(0.1f, -0.2f, 0.1f));
            s.imagery = glm::abs(vec3(b.z, b.x, b.y)) * 0.4f;
            s.night = vec3(0.3f);
            s.water = glm::fract(b.w * 7.0f);
            s.height = b.w * 3000.0f;
            s.footprint = 30000.0f;
            const vec3 want[3] = {cpu.sky_radiance(vec3(a), through), cpu.aerial(cpu.surface_radiance(s), s.view),
                                  cpu.display_from_radiance(vec3(b.w * 2.0f), {static_cast<float>(i) + 0.5f, 2.5f})};
            for (int k = 0; k < 3; ++k) {
                const float* got = &out[static_cast<std::size_t>((2 - k) * n + i) * 4];
                const float error = glm::length(vec3(got[0], got[1], got[2]) - want[k]);
                worse[k] += !(error <= 0.01f * glm::length(want[k]) + 2e-3f);
            }
        }
        // The GPU's own exp and its 8-bit filter weights differ in the last digits; a few rays graze the limb.
        EXPECT_LE(worse[0], n / 200) << h;
        EXPECT_LE(worse[1], n / 200) << h;
        EXPECT_LE(worse[2], n / 200) << h;
    }
}

TEST(SkyGpu, CubeMapsAreTurnedAsOpenGlHasThem) {
    auto context = Context::create();
    std::vector<std::uint8_t> picture;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const dvec3 p =
                planet::normal_from_geodetic(3.14159265 * (0.5 - (y + 0.5) / 128), 6.2831853 * ((x + 0.5) / 256 - 0.5));
            for (int c = 0; c < 3; ++c) picture.push_back(static_cast<std::uint8_t>(std::lround(127.5 + 120 * p[c])));
        }
    const CubeMap cube = cube_from_equirectangular({256, 128, 3, picture}, 64, Encoding::linear);
    Texture texture = Texture::make_cube(GL_RGBA8, 64, static_cast<int>(cube.levels.size()));
    for (std::size_t k = 0; k < cube.levels.size(); ++k)
        texture.upload(static_cast<int>(k), bytes_of(cube.levels[k].texels));
    ProgramOptions options;
    options.find = [](std::string_view name) -> std::optional<std::string_view> {
        if (name != "cube.frag.glsl") return find_shader_source(name);
        return R"(#version 450 core
layout(binding = 0) uniform samplerCube cube;
layout(location = 0) out vec4 color;
void main() {
    vec2 a = vec2(6.2831853, 3.14159265) * (gl_FragCoord.xy / vec2(90, 45) - 0.5);
    vec3 n = vec3(cos(a.y) * cos(a.x), cos(a.y) * sin(a.x), sin(a.y));
    color = vec4(abs(textureLod(cube, n, 0.0).rgb - (0.5 + 120.0 / 255.0 * n)), 1);
}
)";
    };
    const Program program = Program::link({"full_screen.vert.glsl", "cube.frag.glsl"}, options);
    const Framebuffer target(90, 45, {.color_format = GL_RGBA32F, .depth = false});
    target.bind();
    const VertexArray none = VertexArray::create();
    none.bind();
    texture.bind(0);
    program.use();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    for (const float v : target.read_rgba_float()) EXPECT_TRUE(v < 0.015f || v == 1.0f) << v;
}

TEST(SkyGpu, SkyAndStarsDraw) {
    auto context = Context::create();
    const AtmosphereTables tables = make_tables();
    ViewTable view = make_view_table(tables, {6378137.0 + 4e5, 0, 0}, {-1, 0, 0});  // the night side
    view.uniforms.sky_picture = {0, 0, 1, 0.01};
    const Texture air = texture_of(view.air), sun = texture_of(tables.sun_light), sky = texture_of(tables.sky_light);
    air.bind(0), sun.bind(1), sky.bind(2);
    const Buffer block(std::as_bytes(std::span(&view.uniforms, 1)));
    block.bind_base(GL_UNIFORM_BUFFER, 1);
    Program sky_program = Program::link({"sky.vert.glsl", "sky.frag.glsl"});
    Program star_program = Program::link({"stars.vert.glsl", "stars.frag.glsl"});
    // Looking along +x (up), z up in the picture, 90 degrees wide.
    const glm::mat4 ecef_from_clip(0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1);
    glm::mat4 clip_from_ecef(0);
    clip_from_ecef[1][0] = -1, clip_from_ecef[2][1] = 1, clip_from_ecef[0][3] = 1;
    sky_program.set("ecef_direction_from_clip", ecef_from_clip);
    star_program.set("clip_from_ecef_direction", clip_from_ecef);
    star_program.set("ecef_from_inertial", glm::mat3(1));
    const std::vector<Star> stars{make_star(0, 0, 0, 0)};
    const Buffer vertices(bytes_of(stars));
    VertexArray array = VertexArray::create();
    const Attribute attributes[2] = {{0, 3, GL_FLOAT, 0}, {1, 3, GL_FLOAT, sizeof(vec3)}};
    array.set_vertices(0, vertices, sizeof(Star), attributes);
    const Framebuffer target(65, 65);
    target.bind();
    const VertexArray none = VertexArray::create();
    none.bind();
    sky_program.use();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    gl().Enable(GL_PROGRAM_POINT_SIZE);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_ONE, GL_ONE);
    array.bind();
    star_program.use();
    gl().DrawArrays(GL_POINTS, 0, 1);
    const auto pixels = target.read_rgba8();
    const auto brightness = [&](int x, int y) { return int{pixels[static_cast<std::size_t>(y * 65 + x) * 4 + 1]}; };
    EXPECT_GT(brightness(32, 32), 180);
    EXPECT_LT(brightness(24, 32), 4);
    EXPECT_LT(brightness(32, 50), 4);
}

}  // namespace
}  // namespace render
