// The vertex shaders themselves, as this machine's OpenGL runs them: positions go in as a picture's do, and what comes
// out is read back by transform feedback.
//
// The figures hold up to the end of the vertex shader: the division by w, the viewport and the rasterizer's snapping to
// a fraction of a pixel (1/256 in llvmpipe) come after it and are the same for everything at one place.

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <random>

#include "planet/error.h"
#include "planet/geodesy/ellipsoid.h"
#include "render/app/check/check_parts.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/passes/terrain.h"

namespace render {
namespace {

using planet::check_row;
using planet::CheckRow;
using planet::degrees;
using planet::GridPosition;

constexpr double eye_heights[] = {1, 10, 100, 1e3, 10e3, 100e3, 1000e3, 10000e3, 50000e3};  // m
constexpr double pixel_bound = 0.1;
constexpr int width = 1920, height = 1080;
constexpr double field_of_view = 40 * degrees;
constexpr PicturePart whole{0, 0, width, height};

// Poles, E_0, the antimeridian in the middle of a face, a corner of four faces on it, the side of two faces, elsewhere.
constexpr double eye_places[][2] = {{90, 0}, {-90, 0}, {0, 0}, {-16.5, 180}, {0, -180}, {40, 90}, {37.58, -105.49}};
constexpr int looks = 3;  // at the horizon, straight down, half-way between
constexpr std::size_t points_in_view = 6000;
static_assert(std::size(eye_heights) * std::size(eye_places) * looks * points_in_view >= 1000000);

constexpr double nearest_m = 0.5;  // of a vertex from the eye

/// What a program puts out for each vertex.
struct Drawn {
    glm::vec3 view;  // from the eye, m
    glm::vec4 clip;
};
static_assert(sizeof(Drawn) == 28);

/// A vertex shader of ours, and what it makes of grid positions.
class Capture {
  public:
    Capture(std::initializer_list<std::string_view> shaders, const ProgramOptions& options, std::size_t vertex_size)
        : program_(Program::link(shaders, options)),
          array_(VertexArray::create()),
          input_(points_in_view * sizeof(GridPosition)),
          output_(points_in_view * vertex_size, 0) {
        array_.set_vertices(0, input_, sizeof(GridPosition), grid_attributes());
    }

    template <class Vertex>
    std::vector<Vertex> run(const Camera& camera, std::span<const GridPosition> positions) {
        input_.upload(bytes_of(positions));
        program_.use();
        set_grid_camera(program_, camera, whole);
        array_.bind();
        output_.bind_base(GL_TRANSFORM_FEEDBACK_BUFFER, 0);
        gl().BeginTransformFeedback(GL_POINTS);
        gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(positions.size()));
        gl().EndTransformFeedback();
        return output_.download<Vertex>(positions.size());
    }

  private:
    Program program_;
    VertexArray array_;
    Buffer input_, output_;
};

/// Worst figures of all views from one height. Counts are of all vertices; distances are of those that no planet hides.
struct Worst {
    double vertices = 0, misrounded = 0, different = 0;
    double farthest_m = 0, off_m = 0, off_px = 0;
};

constexpr double highest_m = 9e3;  // of terrain above the ellipsoid

/// How far the highest terrain can be seen, m: to the horizon, and from there to a mountain behind it.
double sight(const glm::dvec3& eye) {
    const double ball2 = planet::wgs84.b * planet::wgs84.b, top = planet::wgs84.a + highest_m;
    return std::sqrt(glm::dot(eye, eye) - ball2) + std::sqrt(top * top - ball2);
}

/// Keeps a NaN, so that one fails.
void raise(double& worst, double value) {
    if (!(value <= worst)) worst = std::isnan(worst) ? worst : value;
}

Camera camera_at(double latitude, double longitude, double eye_height, double look) {
    const glm::dvec3 normal = planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
    const glm::dvec3 eye = planet::ecef_from_normal(planet::wgs84, normal, {eye_height});
    const double horizon = std::acos(planet::wgs84.a / (planet::wgs84.a + eye_height));  // below the horizontal
    const double pitch = -(horizon + look * (90 * degrees - horizon));
    return make_camera(eye, normal, 200 * degrees, pitch, focal_length_px(field_of_view, width, height), width, height);
}

/// The pixel of a vector from the eye by the definition of a pinhole camera, in double: no matrix of the camera's.
glm::dvec2 pixel_from_ecef(const Camera& camera, const glm::dvec3& from_eye) {
    const glm::dvec3 v = camera.view_from_ecef * from_eye;
    return {0.5 * width - camera.focal_px * v.x / v.z, 0.5 * height + camera.focal_px * v.y / v.z};
}

glm::dvec2 pixel_from_clip(const glm::vec4& clip) {
    const double w = clip.w;
    return {0.5 * width * (1 + clip.x / w), 0.5 * height * (1 - clip.y / w)};
}

/// Positions inside the picture between the eye and the far side of the planet, near ones as often as distant ones.
class Positions {
  public:
    explicit Positions(const Camera& camera) : camera_(camera) {}

    glm::dvec3 next(std::mt19937_64& engine) const {
        const auto between = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
        };
        for (;;) {  // the planet fills a part of every picture: the least, a fortieth, from 50,000 km
            const double x = between(0, width), y = between(0, height);
            const glm::dvec3 ray = glm::transpose(camera_.view_from_ecef) *
                                   glm::normalize(glm::dvec3(x - 0.5 * width, 0.5 * height - y, -camera_.focal_px));
            const double along = glm::dot(camera_.eye, ray);
            const double inside = reach * reach - (glm::dot(camera_.eye, camera_.eye) - along * along);
            if (inside <= 0) continue;
            const double first = std::max(nearest_m, -along - std::sqrt(inside)), last = -along + std::sqrt(inside);
            if (last <= first) continue;
            return camera_.eye + ray * (first * std::pow(last / first, between(0, 1)));
        }
    }

  private:
    static constexpr double reach = planet::wgs84.a + highest_m;  // from the centre
    const Camera& camera_;
};

bool same_bits(const glm::vec4& a, const glm::vec4& b) {
    return std::bit_cast<std::array<std::uint32_t, 4>>(a) == std::bit_cast<std::array<std::uint32_t, 4>>(b);
}

/// Coordinates that are not the float nearest to the exact difference of grid position and eye.
int misrounded(const Drawn& drawn, const GridPosition& grid, const Camera& camera) {
    const glm::dvec3 exact = planet::ecef_from_grid(grid) - camera.eye;  // exact: below 2^53 grid units
    int wrong = 0;
    for (int axis = 0; axis < 3; ++axis) wrong += drawn.view[axis] != static_cast<float>(exact[axis]);
    return wrong;
}

class Checker {
  public:
    Worst measure(double eye_height) {
        Worst worst;
        for (const auto& [latitude, longitude] : eye_places)
            for (int look = 0; look < looks; ++look)
                measure(camera_at(latitude, longitude, eye_height, look / (looks - 1.0)), worst);
        return worst;
    }

  private:
    void measure(const Camera& camera, Worst& worst) {
        const Positions positions(camera);
        std::vector<glm::dvec3> exact(points_in_view);
        std::vector<GridPosition> grid(points_in_view);
        for (std::size_t i = 0; i < points_in_view; ++i) {
            exact[i] = positions.next(engine_);
            grid[i] = planet::grid_from_ecef(exact[i]);
        }
        const auto terrain = terrain_.run<Drawn>(camera, grid);
        const auto overlay = overlay_.run<glm::vec4>(camera, grid);
        const double far = sight(camera.eye);
        for (std::size_t i = 0; i < points_in_view; ++i) {
            worst.misrounded += misrounded(terrain[i], grid[i], camera);
            worst.different += !same_bits(terrain[i].clip, overlay[i]);
            const glm::dvec3 from_eye = exact[i] - camera.eye;
            const double distance = glm::length(from_eye);
            if (distance > far) continue;
            worst.farthest_m = std::max(worst.farthest_m, distance);
            raise(worst.off_m, glm::distance(glm::dvec3(terrain[i].view), from_eye));
            raise(worst.off_px, glm::distance(pixel_from_clip(terrain[i].clip), pixel_from_ecef(camera, from_eye)));
        }
        worst.vertices += static_cast<double>(points_in_view);
    }

    std::mt19937_64 engine_{1};
    Capture terrain_{{"terrain.vert.glsl", "terrain.frag.glsl"},
                     {.defines = {"PATCHED"}, .feedback_varyings = {"view", "gl_Position"}},
                     sizeof(Drawn)};
    Capture overlay_{
        {"overlay.vert.glsl", "overlay.frag.glsl"}, {.feedback_varyings = {"gl_Position"}}, sizeof(glm::vec4)};
};

std::string distance_text(double metres) {
    char text[32];
    std::snprintf(text, sizeof text, metres < 1e3 ? "%.0f m" : "%.0f km", metres < 1e3 ? metres : metres / 1e3);
    return text;
}

void add_rows(double eye_height, const Worst& worst, std::vector<CheckRow>& rows) {
    // One rounding of each coordinate, and the grid's own.
    const double bound = 0x1p-24 * worst.farthest_m + std::sqrt(3.0) * planet::grid_rounding_m;
    const std::string where =
        " (eye " + distance_text(eye_height) + " up, to " + distance_text(worst.farthest_m) + " away)";
    rows.push_back(check_row("drawn position from the exact one" + where, worst.off_m, bound, "m"));
    rows.push_back(check_row("drawn position from the exact one" + where, worst.off_px, pixel_bound, "pixel"));
}

}  // namespace

CheckPart check_vertex_shaders() {
    std::optional<Context> context;
    try {
        context = Context::create();
    } catch (const planet::Error& error) {
        return {{}, std::string("drawn positions: ") + error.what()};
    }
    const Framebuffer unused(1, 1);  // nothing is rasterized, but there must be one
    unused.bind();
    gl().Enable(GL_RASTERIZER_DISCARD);
    Checker checker;
    Worst all;
    std::vector<CheckRow> by_height;
    for (const double eye_height : eye_heights) {
        const Worst worst = checker.measure(eye_height);
        add_rows(eye_height, worst, by_height);
        all.vertices += worst.vertices;
        all.misrounded += worst.misrounded;
        all.different += worst.different;
    }
    CheckPart part{
        {check_row("drawn vertices checked (" + context->gl_renderer() + ")", all.vertices, all.vertices, "1"),
         check_row("drawn coordinates not correctly rounded", all.misrounded, 0, "1"),
         check_row("vertices that terrain and overlay draw at different places", all.different, 0, "1")},
        {}};
    part.rows.insert(part.rows.end(), by_height.begin(), by_height.end());
    return part;
}

}  // namespace render
