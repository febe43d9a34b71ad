// Shaders: composition by #include, messages that name our file and line, uniforms.
#include "render/gl/shader.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>

#include "planet/error.h"
#include "render/gl/buffer.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"

namespace render {
namespace {

SourceFinder finder(std::map<std::string, std::string, std::less<>> files) {
    return [files = std::move(files)](std::string_view name) -> std::optional<std::string_view> {
        const auto found = files.find(name);
        if (found == files.end()) return std::nullopt;
        return found->second;
    };
}

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), planet::Fault::no_graphics);
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
}

TEST(ShaderSource, EmbeddedFilesAreFound) {
    ASSERT_FALSE(shader_sources().empty());
    for (const ShaderSource& source : shader_sources()) {
        EXPECT_EQ(shader_source(source.name), source.text);
        EXPECT_TRUE(source.name.ends_with(".glsl"));
        EXPECT_TRUE(source.text.ends_with('\n')) << source.name;
    }
    EXPECT_TRUE(shader_source("full_screen.vert.glsl").starts_with("#version 450 core\n"));
    EXPECT_FALSE(find_shader_source("missing.glsl").has_value());
}

TEST(ShaderSource, IncludesKeepTheLinesOfEachFile) {
    const SourceFinder find =
        finder({{"a.frag.glsl", "#version 450 core\nA2\n#include \"b.glsl\"\nA4\n#include \"c.glsl\"\nA6\n"},
                {"b.glsl", "B1\n  #  include  \"c.glsl\"  \r\nB3"},
                {"c.glsl", "C1\n#include \"b.glsl\"\n// #include \"none.glsl\"\n"}});
    const std::vector<std::string> defines{"X 3", "Y"};
    const ComposedShader shader = compose_shader("a.frag.glsl", defines, find);
    EXPECT_EQ(shader.text,
              "#version 450 core\n#define X 3\n#define Y\n#line 2 0\nA2\n"
              "#line 1 1\nB1\n"
              "#line 1 2\nC1\n#line 3 2\n// #include \"none.glsl\"\n"
              "#line 3 1\nB3\n"
              "#line 4 0\nA4\n#line 6 0\nA6\n");
    EXPECT_EQ(shader.files, (std::vector<std::string>{"a.frag.glsl", "b.glsl", "c.glsl"}));
}

TEST(ShaderSource, BadIncludesNameFileAndLine) {
    const auto line = [](const std::string& main, const std::string& part) {
        const SourceFinder find = finder({{"m.frag.glsl", main}, {"p.glsl", part}});
        return error_of([&] { compose_shader("m.frag.glsl", {}, find); });
    };
    const std::string head = "#version 450 core\n";
    EXPECT_TRUE(line(head + "\n#include \"q.glsl\"\n", "").starts_with("m.frag.glsl:3: no shader \"q.glsl\""));
    EXPECT_TRUE(line(head + "#include \"p.glsl\"\n", "\n\n#include <x>\n").starts_with("p.glsl:3: bad #include <x>"));
    EXPECT_TRUE(line(head + "#include \"\"\n", "").starts_with("m.frag.glsl:2: bad #include"));
    EXPECT_TRUE(line(head + "#include\n", "").starts_with("m.frag.glsl:2: bad #include"));
    EXPECT_TRUE(line(head + "#include \"p.glsl\" more\n", "").starts_with("m.frag.glsl:2: bad #include"));
    EXPECT_TRUE(line(head + "#include \"p.glsl\"\n", head).starts_with("p.glsl:1: #version is not the first line"));
    EXPECT_TRUE(line("\n" + head, "").starts_with("m.frag.glsl:1: the first line is not #version"));
    EXPECT_TRUE(line("", "").starts_with("m.frag.glsl:1: the shader is empty"));
    EXPECT_TRUE(error_of([] { compose_shader("none.frag.glsl"); }).starts_with("none.frag.glsl: there is no such"));
}

TEST(ShaderSource, MessagesOfEveryDriverNameTheFile) {
    const std::vector<std::string> files{"a.frag.glsl", "b.glsl"};
    EXPECT_EQ(name_files("1:12(5): error: x undeclared\n0:3(1): warning: y\n", files),
              "b.glsl:12: error: x undeclared\na.frag.glsl:3: warning: y");                               // Mesa
    EXPECT_EQ(name_files("1(12) : error C1503: undefined", files), "b.glsl:12: error C1503: undefined");  // NVIDIA
    EXPECT_EQ(name_files("7:12(5): error: x", files), "7:12(5): error: x");
    EXPECT_EQ(name_files("linking failed", files), "linking failed");
    EXPECT_EQ(name_files("", files), "");
}

class Programs : public testing::Test {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create());
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
    std::optional<Context> context_;
};

TEST_F(Programs, CompileErrorsShowOurFileAndLine) {
    const std::string main =
        "#version 450 core\n#include \"part.glsl\"\nout vec4 color;\nvoid main() {\n"
        "    color = vec4(shade(), MAIN_VALUE, 0, 1);\n}\n";
    const std::string part = "// a part\n\nfloat shade() {\n    return PART_VALUE;\n}\n";
    const SourceFinder find = finder({{"m.frag.glsl", main}, {"part.glsl", part}});
    const std::string_view names[] = {"full_screen.vert.glsl", "m.frag.glsl"};
    const SourceFinder all = [&](std::string_view name) {
        const auto text = find(name);
        return text ? text : find_shader_source(name);
    };
    const auto message = [&](std::vector<std::string> defines) {
        return error_of([&] { Program::link(names, {.defines = std::move(defines), .find = all}); });
    };
    EXPECT_NO_THROW(Program::link(names, {.defines = {"MAIN_VALUE 0.5", "PART_VALUE 0.5"}, .find = all}));
    const std::string in_main = message({"PART_VALUE 0.5"});
    EXPECT_NE(in_main.find("m.frag.glsl:5: "), std::string::npos) << in_main;
    const std::string in_part = message({"MAIN_VALUE 0.5"});
    EXPECT_NE(in_part.find("part.glsl:4: "), std::string::npos) << in_part;
    EXPECT_EQ(in_part.find('\n'), std::string::npos);
    EXPECT_NE(in_part.find("PART_VALUE"), std::string::npos) << in_part;
}

TEST_F(Programs, LinkErrorsNameTheShaders) {
    const SourceFinder find =
        finder({{"a.vert.glsl", "#version 450 core\nout float x;\nvoid main() { x = 1; gl_Position = vec4(0); }\n"},
                {"b.frag.glsl", "#version 450 core\nin vec3 x;\nout vec4 c;\nvoid main() { c = vec4(x, 1); }\n"}});
    const std::string line = error_of([&] { Program::link({"a.vert.glsl", "b.frag.glsl"}, {.find = find}); });
    EXPECT_TRUE(line.starts_with("a.vert.glsl + b.frag.glsl: ")) << line;
    EXPECT_NE(error_of([] { Program::link({"surface.glsl"}); }).find("no shader stage"), std::string::npos);
    EXPECT_EQ(take_gl_errors(), "");
}

TEST_F(Programs, UniformsOfEveryType) {
    const SourceFinder find = finder({{"u.comp.glsl", R"(#version 450 core
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Result { float result[]; };
uniform int i; uniform uint u; uniform float f; uniform vec2 v2; uniform vec3 v3; uniform vec4 v4;
uniform ivec2 i2; uniform ivec3 i3; uniform ivec4 i4; uniform mat3 m3; uniform mat4 m4;
uniform float fs[3]; uniform vec3 v3s[2]; uniform vec4 v4s[2];
void main() {
    result[0] = i; result[1] = u; result[2] = f; result[3] = v2.y; result[4] = v3.z; result[5] = v4.w;
    result[6] = i2.y; result[7] = i3.z; result[8] = i4.w; result[9] = m3[2][1]; result[10] = m4[3][1];
    result[11] = fs[2]; result[12] = v3s[1].z; result[13] = v4s[1].w; result[14] = fs[0]; result[15] = -1;
}
)"}});
    Program program = Program::link({"u.comp.glsl"}, {.find = find});
    program.set("i", -7);
    program.set("u", 8U);
    program.set("f", 0.5F);
    program.set("v2", glm::vec2(1, 2));
    program.set("v3", glm::vec3(1, 2, 3));
    program.set("v4", glm::vec4(1, 2, 3, 4));
    program.set("i2", glm::ivec2(1, 12));
    program.set("i3", glm::ivec3(1, 2, 13));
    program.set("i4", glm::ivec4(1, 2, 3, 14));
    glm::mat3 m3(1);
    m3[2][1] = 21;
    program.set("m3", m3);
    glm::mat4 m4(1);
    m4[3][1] = 31;
    program.set("m4", m4);
    program.set("fs", std::vector<float>{41, 42, 43});
    program.set("v3s", std::vector<glm::vec3>{{0, 0, 0}, {0, 0, 53}});
    program.set("v4s", std::vector<glm::vec4>{{0, 0, 0, 0}, {0, 0, 0, 64}});
    program.set("fs[0]", 40.0F);
    program.set("not_there", 1.0F);
    EXPECT_EQ(program.location("not_there"), -1);
    EXPECT_EQ(program.location("i"), program.location("i"));
    const Buffer result(16 * sizeof(float));
    result.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
    program.use();
    gl().DispatchCompute(1, 1, 1);
    gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    EXPECT_EQ(result.download<float>(16),
              (std::vector<float>{-7, 8, 0.5F, 2, 3, 4, 12, 13, 14, 21, 31, 43, 53, 64, 40, -1}));
    EXPECT_EQ(take_gl_errors(), "");
}

TEST_F(Programs, TheFullScreenTriangleCoversEveryPixelOnce) {
    const SourceFinder find = [](std::string_view name) -> std::optional<std::string_view> {
        if (name != "ndc.frag.glsl") return find_shader_source(name);
        return "#version 450 core\nin vec2 ndc;\nout vec4 c;\nvoid main() { c = vec4(ndc, 1, 1); }\n";
    };
    const Program program = Program::link({"full_screen.vert.glsl", "ndc.frag.glsl"}, {.find = find});
    const Framebuffer framebuffer(16, 8, {.color_format = GL_RGBA32F, .depth = false});
    framebuffer.bind();
    framebuffer.clear(0, 0, 0, 0);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_ONE, GL_ONE);
    const VertexArray empty = VertexArray::create();
    empty.bind();
    program.use();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    const std::vector<float> pixels = framebuffer.read_rgba_float();
    for (std::size_t y = 0; y < 8; ++y)
        for (std::size_t x = 0; x < 16; ++x) {
            const float* p = &pixels[4 * (16 * y + x)];
            EXPECT_NEAR(p[0], (static_cast<float>(x) + 0.5F) / 8 - 1, 1e-6F);
            EXPECT_NEAR(p[1], 1 - (static_cast<float>(y) + 0.5F) / 4, 1e-6F);
            EXPECT_EQ(p[2], 1);
        }
}

}  // namespace
}  // namespace render
