// Handles, buffers, textures and framebuffers in one context of the first way in that works.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "planet/error.h"
#include "render/gl/buffer.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/gl/texture.h"

namespace render {
namespace {

/// Draws rectangles (gl_InstanceID selects one) of given depth and colour.
std::optional<std::string_view> find_test_shader(std::string_view name) {
    if (name == "rectangle.vert.glsl")
        return R"(#version 450 core
uniform vec4 box;    // low x, low y, high x, high y
uniform float depth;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(mix(box.xy, box.zw, corner), depth, 1.0);
}
)";
    if (name == "rectangle.frag.glsl")
        return R"(#version 450 core
uniform vec4 color;
out vec4 result;
void main() { result = color; }
)";
    if (name == "fetch.frag.glsl")
        return R"(#version 450 core
SAMPLER
uniform vec3 at;
uniform float level;
out vec4 result;
void main() { result = textureLod(source, COORDINATE, level); }
)";
    return find_shader_source(name);
}

class GlObjects : public testing::Test {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create());
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
        empty_.emplace(VertexArray::create());
        empty_->bind();
    }
    void TearDown() override {
        if (!context_) return;
        EXPECT_EQ(take_gl_errors(), "");
    }

    void draw_rectangle(const glm::vec4& box, float depth, const glm::vec4& color) {
        if (!rectangle_)
            rectangle_ = Program::link({"rectangle.vert.glsl", "rectangle.frag.glsl"}, {.find = find_test_shader});
        rectangle_.use();
        rectangle_.set("box", box);
        rectangle_.set("depth", depth);
        rectangle_.set("color", color);
        gl().DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }

    /// What a shader reads from a texture.
    std::vector<float> fetch(const Texture& texture, const std::string& sampler, const std::string& coordinate,
                             const glm::vec3& at, float level = 0) {
        Program program = Program::link(
            {"full_screen.vert.glsl", "fetch.frag.glsl"},
            {.defines = {"SAMPLER layout(binding = 3) uniform " + sampler + " source;", "COORDINATE " + coordinate},
             .find = find_test_shader});
        const Framebuffer target(1, 1, {.color_format = GL_RGBA32F, .depth = false});
        target.bind();
        texture.bind(3);
        program.use();
        program.set("at", at);
        program.set("level", level);
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        return target.read_rgba_float();
    }

    std::optional<Context> context_;
    std::optional<VertexArray> empty_;
    Program rectangle_;
};

std::vector<std::uint8_t> pixel(const std::vector<std::uint8_t>& pixels, int width, int x, int y) {
    const auto first = pixels.begin() + 4 * (static_cast<std::ptrdiff_t>(y) * width + x);
    return {first, first + 4};
}

using Bytes = std::vector<std::uint8_t>;

TEST_F(GlObjects, HandlesMove) {
    Buffer one(bytes_of(std::vector<int>{1, 2}), GL_DYNAMIC_STORAGE_BIT);
    const GLuint name = one.name();
    EXPECT_EQ(gl().IsBuffer(name), GL_TRUE);
    Buffer two = std::move(one);
    EXPECT_EQ(two.name(), name);
    EXPECT_EQ(one.name(), 0U);  // NOLINT(bugprone-use-after-move): a moved-from handle is empty
    Buffer& same = two;
    two = std::move(same);
    EXPECT_EQ(two.name(), name);
    two = Buffer(8);
    EXPECT_EQ(gl().IsBuffer(name), GL_FALSE);

    Texture texture = Texture::make_2d(GL_RGBA8, 4, 4);
    const Texture moved = std::move(texture);
    EXPECT_FALSE(static_cast<bool>(texture));  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(gl().IsTexture(moved.name()), GL_TRUE);
    Framebuffer framebuffer(2, 2);
    Framebuffer kept;
    kept = std::move(framebuffer);
    EXPECT_FALSE(static_cast<bool>(framebuffer));  // NOLINT(bugprone-use-after-move)
    kept.clear(1, 0, 0, 1);
    EXPECT_EQ(kept.read_rgba8().front(), 255);
}

TEST_F(GlObjects, Buffers) {
    Buffer buffer(bytes_of(std::vector<int>{1, 2, 3}), GL_DYNAMIC_STORAGE_BIT);
    buffer.upload(bytes_of(std::vector<int>{9}), 4);
    EXPECT_EQ(buffer.download<int>(3), (std::vector<int>{1, 9, 3}));
    EXPECT_EQ(buffer.download<int>(1, 8), std::vector<int>{3});
    const Buffer nothing(bytes_of(std::vector<int>{}));
    EXPECT_EQ(nothing.size(), 0U);
    nothing.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
    EXPECT_EQ(nothing.download<int>(0), std::vector<int>{});
}

TEST_F(GlObjects, MemoryThatIsNotThere) {
    const std::size_t huge = static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max()) / 2;
    EXPECT_THROW(Buffer{huge}, planet::Error);
    EXPECT_EQ(take_gl_errors(), "");  // told once
}

TEST_F(GlObjects, OnePixelAndTheLargest) {
    const int largest = context_->limits().target_size;
    for (const glm::ivec2 size :
         {glm::ivec2(1, 1), glm::ivec2(largest, 1), glm::ivec2(1, largest), glm::ivec2(largest, 3), glm::ivec2(3, 2)}) {
        const Framebuffer framebuffer(size.x, size.y);
        framebuffer.bind();
        framebuffer.clear(0, 0, 1, 1);
        draw_rectangle({0, 0, 1, 1}, 0, {1, 0, 0, 1});  // the upper right quarter
        const Bytes pixels = framebuffer.read_rgba8();
        ASSERT_EQ(pixels.size(), 4U * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const bool inside = 2 * x + 1 >= size.x && 2 * y + 1 <= size.y;
                const bool edge = 2 * x + 1 == size.x || 2 * y + 1 == size.y;
                const Bytes expected = inside ? Bytes{255, 0, 0, 255} : Bytes{0, 0, 255, 255};
                if (edge) continue;
                ASSERT_EQ(pixel(pixels, size.x, x, y), expected) << size.x << "x" << size.y << " " << x;
            }
    }
    for (const glm::ivec2 size : {glm::ivec2(0, 1), glm::ivec2(1, -1), glm::ivec2(largest + 1, 1)}) {
        try {
            const Framebuffer framebuffer(size.x, size.y);
            ADD_FAILURE();
        } catch (const planet::Error& error) {
            EXPECT_EQ(error.fault(), planet::Fault::bad_usage);
            EXPECT_NE(std::string(error.what()).find("1x1 to " + std::to_string(largest)), std::string::npos);
        }
    }
    EXPECT_THROW(Framebuffer(4, 4, {.samples = context_->limits().samples + 1}), planet::Error);
    EXPECT_THROW(Framebuffer(4, 4, {.samples = 0}), planet::Error);
}

TEST_F(GlObjects, TopRowComesFirstAndStrideIsKept) {
    const Framebuffer framebuffer(5, 3);
    framebuffer.bind();
    framebuffer.clear(0, 0, 0, 0);
    draw_rectangle({-1, 1.0F / 3, 1, 1}, 0, {1, 1, 1, 1});  // the top row
    constexpr std::size_t stride = 7;
    Bytes pixels(4 * (2 * stride + 5), 77);
    framebuffer.read_rgba8(pixels, stride);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::size_t x = i / 4 % stride, y = i / 4 / stride;
        ASSERT_EQ(pixels[i], x >= 5 ? 77 : (y == 0 ? 255 : 0)) << x << ", " << y;
    }
    EXPECT_EQ(framebuffer.read_rgba_float().front(), 1);
    EXPECT_EQ(framebuffer.read_rgba_float().back(), 0);
}

TEST_F(GlObjects, DepthIsReversed) {
    set_reversed_depth();
    for (const int samples : {1, 4}) {
        const Framebuffer framebuffer(4, 4, {.samples = samples});
        framebuffer.bind();
        framebuffer.clear(0, 0, 0, 1);
        const float near_depth = 0.75F, far_depth = 1e-30F;  // fixed point or [-1, 1] would lose the far one
        draw_rectangle({-1, -1, 0, 1}, near_depth, {0, 1, 0, 1});
        draw_rectangle({-1, -1, 1, 1}, far_depth, {1, 0, 0, 1});  // behind the green half
        draw_rectangle({-1, -1, 1, 1}, 0.0F, {0, 0, 1, 1});       // as far as nothing: not greater
        draw_rectangle({-1, -1, 1, 1}, 1.0001F, {0, 0, 1, 1});    // before the near plane: clipped
        draw_rectangle({-1, -1, 1, 1}, -0.0001F, {0, 0, 1, 1});   // beyond the far plane: clipped
        const Bytes pixels = framebuffer.read_rgba8();
        EXPECT_EQ(pixel(pixels, 4, 0, 0), (Bytes{0, 255, 0, 255}));
        EXPECT_EQ(pixel(pixels, 4, 3, 3), (Bytes{255, 0, 0, 255}));
        const std::vector<float> depth = framebuffer.read_depth();
        EXPECT_EQ(depth.front(), near_depth);
        EXPECT_EQ(depth.back(), far_depth);
    }
}

TEST_F(GlObjects, SamplesAreAveraged) {
    const Framebuffer framebuffer(64, 64, {.samples = 4});
    framebuffer.bind();
    framebuffer.clear(0, 0, 0, 1);
    draw_rectangle({-1, -1, 1.0F / 64, 1}, 0, {1, 1, 1, 1});  // half of column 32
    const Bytes pixels = framebuffer.read_rgba8();
    EXPECT_EQ(pixel(pixels, 64, 31, 9)[0], 255);
    EXPECT_NEAR(pixel(pixels, 64, 32, 9)[0], 128, 1);
    EXPECT_EQ(pixel(pixels, 64, 33, 9)[0], 0);
}

TEST_F(GlObjects, FloatPicturesAreClampedAndRounded) {
    const Framebuffer framebuffer(2, 1, {.color_format = GL_RGBA16F});
    framebuffer.clear(7, -3, 0.5F, 100.0F / 255);
    const Bytes bytes = framebuffer.read_rgba8();
    EXPECT_EQ(bytes[0], 255);
    EXPECT_EQ(bytes[1], 0);
    EXPECT_NEAR(bytes[2], 128, 1);
    EXPECT_EQ(bytes[3], 100);
    const std::vector<float> values = framebuffer.read_rgba_float();
    EXPECT_EQ(values[0], 7);
    EXPECT_EQ(values[1], -3);
}

TEST_F(GlObjects, TexturesKeepTheirTexels) {
    const auto check = [](Texture texture) {
        for (int level = 0; level < texture.levels(); ++level) {
            std::vector<std::byte> texels(texture.level_bytes(level));
            for (std::size_t i = 0; i < texels.size(); ++i)  // below 0x3c everywhere: no half or float is a NaN
                texels[i] = static_cast<std::byte>((i * 31 + static_cast<std::size_t>(level)) % 59);
            texture.upload(level, texels);
            EXPECT_TRUE(texture.download(level) == texels) << std::hex << texture.internal_format() << " " << level;
        }
        EXPECT_EQ(take_gl_errors(), "");
    };
    for (const GLenum format :
         {GL_R8,           GL_RG8,         GL_RGB8,  GL_RGBA8,   GL_SRGB8,  GL_SRGB8_ALPHA8, GL_R8_SNORM,
          GL_RG8_SNORM,    GL_RGBA8_SNORM, GL_R16,   GL_RG16,    GL_RGBA16, GL_R16_SNORM,    GL_RG16_SNORM,
          GL_RGBA16_SNORM, GL_R16F,        GL_RG16F, GL_RGBA16F, GL_R32F,   GL_RG32F,        GL_RGBA32F,
          GL_R8UI,         GL_R16UI,       GL_R16I,  GL_R32UI,   GL_RG32UI, GL_RGBA32UI,     GL_DEPTH_COMPONENT32F})
        check(Texture::make_2d(format, 7, 5, mip_levels(7, 5)));  // odd rows: packed, without padding
    check(Texture::make_2d_array(GL_RG8_SNORM, 65, 65, 9, mip_levels(65, 65)));
    check(Texture::make_3d(GL_RGBA16F, 17, 9, 33, mip_levels(17, 9, 33)));
    check(Texture::make_cube(GL_SRGB8_ALPHA8, 16, mip_levels(16, 16)));
}

TEST_F(GlObjects, MipLevels) {
    EXPECT_EQ(mip_levels(1, 1), 1);
    EXPECT_EQ(mip_levels(2, 1), 2);
    EXPECT_EQ(mip_levels(65, 65), 7);
    EXPECT_EQ(mip_levels(4, 4, 16384), 15);
    const Texture volume = Texture::make_3d(GL_R8, 5, 1, 8, 4);
    EXPECT_EQ(volume.width(1), 2);
    EXPECT_EQ(volume.height(3), 1);
    EXPECT_EQ(volume.depth(3), 1);
    EXPECT_EQ(volume.level_bytes(1), 2U * 1 * 4);
}

TEST_F(GlObjects, TexturesOfImpossibleSize) {
    const Limits& limits = context_->limits();
    EXPECT_THROW(Texture::make_2d(GL_RGBA8, 0, 1), planet::Error);
    EXPECT_THROW(Texture::make_2d(GL_RGBA8, 1, limits.texture_size + 1), planet::Error);
    EXPECT_THROW(Texture::make_cube(GL_RGBA8, limits.cube_size + 1), planet::Error);
    EXPECT_THROW(Texture::make_3d(GL_RGBA8, 1, 1, limits.volume_size + 1), planet::Error);
    EXPECT_THROW(Texture::make_2d_array(GL_RGBA8, 1, 1, limits.array_layers + 1), planet::Error);
}

TEST_F(GlObjects, ShadersReadEveryKindOfTexture) {
    Texture plane = Texture::make_2d(GL_SRGB8_ALPHA8, 2, 2);
    plane.upload(0, bytes_of(Bytes{0, 0, 0, 0, 188, 255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0}));
    const std::vector<float> color = fetch(plane, "sampler2D", "at.xy", {0.75F, 0.25F, 0});
    EXPECT_NEAR(color[0], 0.5029F, 0.002F);  // sRGB decoded ...
    EXPECT_NEAR(color[3], 0.2F, 1e-5F);      // ... and alpha as it is

    // Faces by direction: each face of the smaller level has its number.
    Texture cube = Texture::make_cube(GL_R8, 2, 2);
    cube.upload(0, bytes_of(Bytes(24, 200)));
    for (int face = 0; face < 6; ++face)
        cube.upload_layer(1, face, bytes_of(Bytes{static_cast<std::uint8_t>(face * 10)}));
    for (int face = 0; face < 6; ++face) {
        glm::vec3 direction(0);
        direction[face / 2] = face % 2 == 0 ? 1.0F : -1.0F;
        EXPECT_NEAR(fetch(cube, "samplerCube", "at", direction, 1)[0] * 255, face * 10, 0.01) << face;
    }

    Texture volume = Texture::make_3d(GL_R32F, 1, 1, 2);
    volume.upload(0, bytes_of(std::vector<float>{1, 3}));
    EXPECT_EQ(fetch(volume, "sampler3D", "at", {0.5F, 0.5F, 0.5F})[0], 2);
    EXPECT_EQ(fetch(volume, "sampler3D", "at", {0.5F, 0.5F, -4})[0], 1);  // clamped to the edge

    Texture layers = Texture::make_2d_array(GL_R32F, 1, 1, 2);
    layers.upload_box(0, 0, 0, 1, 1, 1, 1, bytes_of(std::vector<float>{5}));
    EXPECT_EQ(fetch(layers, "sampler2DArray", "at", {0.5F, 0.5F, 1})[0], 5);
    Sampling nearest;
    nearest.min_filter = nearest.mag_filter = GL_NEAREST;
    const Sampler sampler(nearest);
    sampler.bind(3);
    EXPECT_EQ(fetch(volume, "sampler3D", "at", {0.5F, 0.5F, 0.6F})[0], 3);  // the sampler overrides the texture's own
    gl().BindSampler(3, 0);
}

TEST_F(GlObjects, AttributesOfEveryConversion) {
    struct Vertex {
        GLuint word;
        std::uint8_t shade;
        std::uint8_t padding[3];
    };
    const std::vector<Vertex> vertices{{0xFFFFFFFFU, 255, {}}, {7, 51, {}}};
    const Buffer buffer(bytes_of(vertices)), indices(bytes_of(std::vector<std::uint16_t>{1, 0}));
    VertexArray array = VertexArray::create();
    using Conversion = Attribute::Conversion;
    array.set_vertices(0, buffer, sizeof(Vertex),
                       std::vector<Attribute>{{0, 1, GL_UNSIGNED_INT, 0, Conversion::integer},
                                              {1, 1, GL_UNSIGNED_BYTE, 4, Conversion::normalized},
                                              {2, 1, GL_UNSIGNED_BYTE, 4, Conversion::to_float}});
    array.set_indices(indices);
    const auto find = [](std::string_view) -> std::optional<std::string_view> {
        return R"(#version 450 core
layout(location = 0) in uint word;
layout(location = 1) in float shade;
layout(location = 2) in float plain;
out uint word_out;
out vec2 shades_out;
void main() { word_out = word; shades_out = vec2(shade, plain); gl_Position = vec4(0.0); }
)";
    };
    const Program program =
        Program::link({"capture.vert.glsl"}, {.feedback_varyings = {"word_out", "shades_out"}, .find = find});
    const Buffer captured(24);
    captured.bind_base(GL_TRANSFORM_FEEDBACK_BUFFER, 0);
    const Framebuffer target(1, 1);  // even without any pixel, drawing needs a complete framebuffer
    target.bind();
    array.bind();
    program.use();
    gl().Enable(GL_RASTERIZER_DISCARD);
    gl().BeginTransformFeedback(GL_POINTS);
    gl().DrawElements(GL_POINTS, 2, GL_UNSIGNED_SHORT, nullptr);
    gl().EndTransformFeedback();
    gl().Disable(GL_RASTERIZER_DISCARD);
    const std::vector<GLuint> words = captured.download<GLuint>(6);
    const std::vector<float> values = captured.download<float>(6);
    EXPECT_EQ(words[0], 7U);
    EXPECT_NEAR(values[1], 0.2F, 1e-6F);
    EXPECT_EQ(values[2], 51);
    EXPECT_EQ(words[3], 0xFFFFFFFFU);
    EXPECT_EQ(values[4], 1);
}

}  // namespace
}  // namespace render
