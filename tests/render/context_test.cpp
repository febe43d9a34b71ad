// The ways into OpenGL: each draws the same bytes, several live in one process, and a missing library is told in a
// line.
#include "render/gl/context.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "planet/error.h"
#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/gl/texture.h"

#ifdef __SANITIZE_ADDRESS__
// OSMesa keeps a few hundred bytes of each context.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libOSMesa\n";
}
#endif

namespace render {
namespace {

/// Sets an environment variable while it lives.
class Environment {
  public:
    Environment(const char* name, const char* value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value, 1);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() {
        if (before_)
            setenv(name_, before_->c_str(), 1);
        else
            unsetenv(name_);
    }

  private:
    const char* name_;
    std::optional<std::string> before_;
};

std::vector<BackendChoice> available_backends() {
    static const std::vector<BackendChoice> backends = [] {
        std::vector<BackendChoice> found;
        for (const BackendProbe& probe : probe_backends())
            if (probe.available) found.push_back(*backend_from_name(probe.name));
        return found;
    }();
    return backends;
}

std::optional<std::string_view> find_test_shader(std::string_view name) {
    if (name == "sphere.vert.glsl")
        return R"(#version 450 core
layout(location = 0) in vec3 position;
out vec3 normal;
void main() {
    normal = position;
    gl_Position = vec4(0.9 * position.xy, 0.5 - 0.4 * position.z, 1.0);
}
)";
    if (name == "sphere.frag.glsl")
        return R"(#version 450 core
layout(binding = 0) uniform samplerCube imagery;
uniform vec3 to_sun;
in vec3 normal;
out vec4 color;
void main() {
    vec3 n = normalize(normal);
    color = vec4(texture(imagery, n).rgb * (0.1 + 0.9 * max(dot(n, to_sun), 0.0)), 1.0);
}
)";
    return std::nullopt;
}

struct Sphere {
    std::vector<glm::vec3> positions;
    std::vector<GLuint> indices;
};

Sphere make_sphere(GLuint rings, GLuint sectors) {
    Sphere sphere;
    for (GLuint i = 0; i <= rings; ++i)
        for (GLuint j = 0; j <= sectors; ++j) {
            const float a = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
            const float b = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(sectors);
            sphere.positions.emplace_back(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
        }
    for (GLuint i = 0; i < rings; ++i)
        for (GLuint j = 0; j < sectors; ++j) {
            const GLuint k = i * (sectors + 1) + j;
            sphere.indices.insert(sphere.indices.end(),
                                  {k, k + 1, k + sectors + 1, k + 1, k + sectors + 2, k + sectors + 1});
        }
    return sphere;
}

/// A cube map with a full mip chain whose texels tell face, place and level apart.
Texture make_imagery(int size) {
    Texture texture = Texture::make_cube(GL_SRGB8_ALPHA8, size, mip_levels(size, size));
    for (int level = 0; level < texture.levels(); ++level) {
        std::vector<unsigned char> texels(texture.level_bytes(level));
        for (std::size_t i = 0; i < texels.size(); ++i)
            texels[i] = static_cast<unsigned char>((i * 2654435761U + static_cast<std::size_t>(level) * 40) >> 7);
        texture.upload(level, bytes_of(texels));
    }
    return texture;
}

/// A lit, textured sphere in the current context: texture, depth, interpolation, blending of mip levels.
std::vector<std::uint8_t> draw_sphere(int samples) {
    set_reversed_depth();
    const Framebuffer framebuffer(320, 240, {.samples = samples});
    Program program = Program::link({"sphere.vert.glsl", "sphere.frag.glsl"}, {.find = find_test_shader});
    const Sphere sphere = make_sphere(40, 80);
    const Buffer vertices(bytes_of(sphere.positions)), indices(bytes_of(sphere.indices));
    VertexArray array = VertexArray::create();
    array.set_vertices(0, vertices, sizeof(glm::vec3), std::vector<Attribute>{{.location = 0, .components = 3}});
    array.set_indices(indices);
    const Texture imagery = make_imagery(64);
    imagery.bind(0);
    program.use();
    program.set("to_sun", glm::normalize(glm::vec3(1, 1, -1)));
    framebuffer.bind();
    framebuffer.clear(0, 0, 0.25F, 1);
    array.bind();
    gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(sphere.indices.size()), GL_UNSIGNED_INT, nullptr);
    std::vector<std::uint8_t> pixels = framebuffer.read_rgba8();
    EXPECT_EQ(take_gl_errors(), "");
    return pixels;
}

std::size_t count_lit(const std::vector<std::uint8_t>& pixels) {
    std::size_t lit = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 4) lit += pixels[i] + pixels[i + 1] > 0 ? 1 : 0;
    return lit;
}

TEST(Context, NamesOfBackends) {
    for (const std::string_view name : {"auto", "egl", "egl-device", "egl-surfaceless", "osmesa"})
        EXPECT_EQ(backend_name(backend_from_name(name).value()), name);
    EXPECT_FALSE(backend_from_name("glx").has_value());
    EXPECT_FALSE(backend_from_name("").has_value());
}

TEST(Context, EveryWayInIsTold) {
    const std::vector<BackendProbe> probes = probe_backends();
    ASSERT_EQ(probes.size(), 3U);
    EXPECT_EQ(probes[0].name, "egl-device");
    EXPECT_EQ(probes[1].name, "egl-surfaceless");
    EXPECT_EQ(probes[2].name, "osmesa");
    for (const BackendProbe& probe : probes) {
        EXPECT_NE(probe.available, probe.gl_version.empty()) << probe.name;
        EXPECT_NE(probe.available, !probe.reason.empty()) << probe.name;
        EXPECT_EQ(probe.reason.find('\n'), std::string::npos);
        EXPECT_EQ(probe.available && probe.name == "egl-device", !probe.devices.empty());
    }
    EXPECT_FALSE(has_gl());
}

TEST(Context, EveryWayInDrawsTheSameBytes) {
    if (available_backends().empty()) GTEST_SKIP() << "no OpenGL here";
    for (const int samples : {1, 4}) {
        std::vector<std::uint8_t> first;
        std::string first_renderer;
        for (const BackendChoice backend : available_backends()) {
            const Context context = Context::create({.backend = backend});
            EXPECT_EQ(context.backend(), backend);
            const std::vector<std::uint8_t> pixels = draw_sphere(samples);
            const std::size_t lit = count_lit(pixels);
            EXPECT_NEAR(static_cast<double>(lit), 0.81 * std::numbers::pi * 160 * 120, 1000) << backend_name(backend);
            if (first.empty()) {
                first = pixels;
                first_renderer = context.gl_renderer();
            } else if (context.gl_renderer() == first_renderer) {  // a GPU and llvmpipe may differ
                EXPECT_TRUE(pixels == first) << backend_name(backend) << ", " << samples << " samples";
            }
        }
    }
}

TEST(Context, AutomaticTakesTheFirstThatWorks) {
    if (available_backends().empty()) GTEST_SKIP() << "no OpenGL here";
    const Context context = Context::create();
    EXPECT_EQ(context.backend(), available_backends().front());
    EXPECT_GE(context.limits().target_size, 16384);
    EXPECT_GE(context.limits().samples, 4);
    EXPECT_EQ(context.device().has_value(), context.backend() == BackendChoice::egl_device);
}

TEST(Context, TwoContextsInTurn) {
    for (const BackendChoice one : available_backends())
        for (const BackendChoice two : available_backends()) {
            SCOPED_TRACE(std::string(backend_name(one)) + " and " + std::string(backend_name(two)));
            Context first = Context::create({.backend = one});
            Buffer of_first(bytes_of(std::vector<int>{1, 2, 3}));
            Context second = Context::create({.backend = two});
            Buffer of_second(bytes_of(std::vector<int>{4, 5, 6}));
            EXPECT_EQ(of_first.name(), of_second.name());  // names are the context's own
            of_first = Buffer();                           // the second's buffer of that name must not go
            EXPECT_EQ(of_second.download<int>(3), (std::vector<int>{4, 5, 6}));
            first.make_current();
            EXPECT_EQ(count_lit(draw_sphere(1)), count_lit(draw_sphere(1)));
            second.make_current();
            EXPECT_EQ(of_second.download<int>(3), (std::vector<int>{4, 5, 6}));
            Context third = std::move(second);  // still the current one
            EXPECT_EQ(of_second.download<int>(3), (std::vector<int>{4, 5, 6}));
        }
    EXPECT_FALSE(has_gl());
}

TEST(Context, ProbingKeepsTheCurrentContext) {
    if (available_backends().empty()) GTEST_SKIP() << "no OpenGL here";
    const Context context = Context::create();
    const std::uint32_t id = gl().context_id;
    const Buffer buffer(bytes_of(std::vector<int>{7}));
    probe_backends();
    ASSERT_TRUE(has_gl());
    EXPECT_EQ(gl().context_id, id);
    EXPECT_EQ(buffer.download<int>(1), std::vector<int>{7});
}

TEST(Context, HandlesMayOutliveTheirContext) {
    if (available_backends().empty()) GTEST_SKIP() << "no OpenGL here";
    Buffer buffer;
    {
        const Context context = Context::create();
        buffer = Buffer(16);
    }
    EXPECT_FALSE(has_gl());
    buffer = Buffer();
    EXPECT_FALSE(static_cast<bool>(buffer));
}

TEST(Context, EachThreadHasItsOwn) {
    std::vector<std::vector<std::uint8_t>> pictures(2 * available_backends().size());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        threads.emplace_back([&pictures, i] {
            const Context context = Context::create({.backend = available_backends()[i / 2]});
            pictures[i] = draw_sphere(1);
        });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < pictures.size(); i += 2) {
        ASSERT_GT(pictures[i].size(), 0U);
        EXPECT_TRUE(pictures[i] == pictures[i + 1]);
    }
}

/// The error of making a context; an empty one fails the test.
std::string failure(const ContextOptions& options, planet::Fault fault) {
    try {
        Context::create(options);
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), fault);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    ADD_FAILURE() << "a context was made";
    return {};
}

TEST(Context, WithoutAnyLibraryOneLineNamesAllThree) {
    const Environment egl("OCTAGLOBE_EGL_LIBRARY", "/nonexistent/libEGL.so.1");
    const Environment osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nonexistent/libOSMesa.so.8");
    const std::string line = failure({}, planet::Fault::no_graphics);
    for (const char* part : {"egl-device", "egl-surfaceless", "osmesa", "/nonexistent/libEGL.so.1",
                             "/nonexistent/libOSMesa.so.8", "accepted: "})
        EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
    for (const BackendProbe& probe : probe_backends()) {
        EXPECT_FALSE(probe.available);
        EXPECT_NE(probe.reason.find("/nonexistent/"), std::string::npos) << probe.reason;
    }
}

TEST(Context, WithoutEglOsmesaIsTaken) {
    if (available_backends().empty() || available_backends().back() != BackendChoice::osmesa) GTEST_SKIP();
    const Environment egl("OCTAGLOBE_EGL_LIBRARY", "/nonexistent/libEGL.so.1");
    EXPECT_EQ(Context::create().backend(), BackendChoice::osmesa);
    const std::string line = failure({.backend = BackendChoice::egl}, planet::Fault::no_graphics);
    EXPECT_NE(line.find("egl-device and egl-surfaceless: "), std::string::npos) << line;
    EXPECT_EQ(line.find("osmesa:"), std::string::npos) << line;
}

TEST(Context, AnotherLibraryOfThatName) {
    const Environment egl("OCTAGLOBE_EGL_LIBRARY", "libm.so.6");
    const Environment osmesa("OCTAGLOBE_OSMESA_LIBRARY", "libm.so.6");
    const std::string line = failure({}, planet::Fault::no_graphics);
    EXPECT_NE(line.find("libm.so.6 is not EGL"), std::string::npos) << line;
    EXPECT_NE(line.find("libm.so.6 is not OSMesa"), std::string::npos) << line;
}

TEST(Context, FailureLeavesTheCurrentContext) {
    if (available_backends().empty()) GTEST_SKIP() << "no OpenGL here";
    const Context context = Context::create();
    const std::uint32_t id = gl().context_id;
    const Environment osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nonexistent");
    failure({.backend = BackendChoice::osmesa}, planet::Fault::no_graphics);
    EXPECT_EQ(gl().context_id, id);
}

TEST(Context, Devices) {
    const BackendProbe probe = probe_backends().front();
    if (!probe.available) GTEST_SKIP() << probe.reason;
    const int count = static_cast<int>(probe.devices.size());
    for (const int bad : {-1, count, 1000000}) {
        const std::string line = failure({.device = bad}, planet::Fault::bad_usage);
        EXPECT_NE(line.find(std::to_string(bad)), std::string::npos) << line;
    }
    failure({.backend = BackendChoice::osmesa, .device = 0}, planet::Fault::bad_usage);
    const Context any = Context::create({.backend = BackendChoice::egl_device});
    const Context same = Context::create({.device = any.device()});
    EXPECT_EQ(same.gl_renderer(), any.gl_renderer());
}

TEST(Context, DebugMessagesArrive) {
    for (const BackendChoice backend : available_backends()) {
        Context context = Context::create({.backend = backend, .debug = true});
        int calls = 0;
        context.debug_log().set_callback([&](const DebugMessage&) { ++calls; });
        gl().Enable(GL_NONE);
        EXPECT_EQ(calls, 1) << backend_name(backend);
        ASSERT_EQ(context.debug_log().messages().size(), 1U);
        EXPECT_EQ(context.debug_log().messages().front().type, static_cast<GLenum>(GL_DEBUG_TYPE_ERROR));
        EXPECT_THROW(require_gl("Enable"), planet::Error);
        EXPECT_NO_THROW(require_gl("Enable"));  // once told, forgotten
    }
}

}  // namespace
}  // namespace render
