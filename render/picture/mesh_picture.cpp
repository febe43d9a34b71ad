#include "render/picture/mesh_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "planet/error.h"
#include "render/gl/buffer.h"
#include "render/gl/context.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"
#include "render/picture/camera.h"
#include "render/picture/mesh_figure.h"

namespace render {
namespace {

constexpr int part_side = 2048;
constexpr std::size_t batch_triangles = std::size_t{1} << 17, batch_strokes = std::size_t{1} << 15;
constexpr std::string_view where = "a picture of a mesh";

void check(const MeshPicture& p) {
    using planet::Error;
    using planet::Fault;
    assert(p.level.size() == p.triangles.size() && (p.step.empty() || p.step.size() == p.triangles.size()));
    const std::string least = std::to_string(picture_size_min), most = std::to_string(picture_size_max);
    if (std::min(p.width, p.height) < picture_size_min || std::max(p.width, p.height) > picture_size_max)
        throw Error(Fault::bad_usage, where, std::to_string(p.width) + "x" + std::to_string(p.height) + " pixels",
                    least + "x" + least + " to " + most + "x" + most);
    if (!p.planet && !(std::isnormal(p.metres_per_unit.x) && std::isnormal(p.metres_per_unit.y) &&
                       std::min(p.metres_per_unit.x, p.metres_per_unit.y) > 0))
        throw Error(Fault::bad_usage, where, "units without length");
    if (p.triangles.empty() || p.vertices.empty()) throw Error(Fault::bad_data, where, "there are no triangles");
    const auto finite = [](const glm::dvec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    if (!std::ranges::all_of(p.vertices, finite) || !std::ranges::all_of(p.marks, finite))
        throw Error(Fault::bad_data, where, "a vertex without a place", "finite coordinates");
    for (const auto& t : p.triangles)
        if (std::ranges::max(t) >= p.vertices.size())
            throw Error(Fault::bad_data, where, "vertex " + std::to_string(std::ranges::max(t)),
                        "0 to " + std::to_string(p.vertices.size() - 1));
}

/// Shadows are blue, as under a clear sky; what is brighter than level ground goes towards white.
Color shaded(Color c, float shade) {
    const glm::vec3 whole(c.red, c.green, c.blue);
    constexpr glm::vec3 shadow(0.36f, 0.44f, 0.62f);
    const glm::vec3 x = shade <= 1 ? whole * glm::mix(shadow, glm::vec3(1), shade)
                                   : glm::mix(whole, glm::vec3(255), std::min(shade - 1, 1.0f));
    const auto one = [](float v) { return static_cast<std::uint8_t>(v + 0.5f); };
    return {one(x.r), one(x.g), one(x.b), c.alpha};
}

bool outside(const PicturePart& part, const glm::vec2& low, const glm::vec2& high) {
    return high.x < static_cast<float>(part.x) || low.x > static_cast<float>(part.x + part.width) ||
           high.y < static_cast<float>(part.y) || low.y > static_cast<float>(part.y + part.height);
}

glm::vec3 rgb(Color c) {
    return glm::vec3(c.red, c.green, c.blue) / 255.0f;
}

/// Triangles in batches.
class FillPass {
  public:
    FillPass()
        : program_(Program::link({"mesh_fill.vert.glsl", "mesh_fill.frag.glsl"})),
          buffer_(3 * batch_triangles * sizeof(FillCorner)),
          array_(VertexArray::create()) {
        const Attribute attributes[] = {{.location = 0, .components = 3},
                                        {.location = 1,
                                         .components = 4,
                                         .type = GL_UNSIGNED_BYTE,
                                         .offset = sizeof(glm::vec3),
                                         .conversion = Attribute::Conversion::normalized}};
        array_.set_vertices(0, buffer_, sizeof(FillCorner), attributes);
        corners_.reserve(3 * batch_triangles);
    }

    Program& program() { return program_; }
    void add(const FillCorner& a, const FillCorner& b, const FillCorner& c) {
        if (corners_.size() == 3 * batch_triangles) flush();
        corners_.insert(corners_.end(), {a, b, c});
    }
    void flush() {
        if (corners_.empty()) return;
        buffer_.upload(bytes_of(corners_));
        program_.use();
        array_.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size()));
        corners_.clear();
    }

  private:
    Program program_;
    Buffer buffer_;
    VertexArray array_;
    std::vector<FillCorner> corners_;
};

/// Strokes in batches, in the order in which they come.
class StrokePass {
  public:
    StrokePass()
        : program_(Program::link({"mesh_stroke.vert.glsl", "mesh_stroke.frag.glsl"})),
          buffer_(4 * batch_strokes * sizeof(Stroke)),
          indices_(bytes_of(rectangle_indices())),
          array_(VertexArray::create()) {
        const Attribute attributes[] = {{.location = 0, .components = 3},
                                        {.location = 1, .components = 3, .offset = offsetof(Stroke, b)},
                                        {.location = 2, .components = 1, .offset = offsetof(Stroke, width)},
                                        {.location = 3,
                                         .components = 4,
                                         .type = GL_UNSIGNED_BYTE,
                                         .offset = offsetof(Stroke, color),
                                         .conversion = Attribute::Conversion::normalized}};
        array_.set_vertices(0, buffer_, sizeof(Stroke), attributes);
        array_.set_indices(indices_);
        corners_.reserve(4 * batch_strokes);
    }

    Program& program() { return program_; }
    void add(const Stroke& stroke) {
        const bool lightens = with_alpha(stroke.color, 1) == figure_color::paper;
        if (lightens != lightens_ || corners_.size() == 4 * batch_strokes) flush();
        lightens_ = lightens;
        corners_.insert(corners_.end(), 4, stroke);
    }
    void flush() {
        if (corners_.empty()) return;
        buffer_.upload(bytes_of(corners_));
        program_.use();
        program_.set("lightens", static_cast<GLint>(lightens_));
        gl().BlendEquation(lightens_ ? GL_MAX : GL_MIN);
        array_.bind();
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(corners_.size() / 4 * 6), GL_UNSIGNED_INT, nullptr);
        corners_.clear();
    }

  private:
    static std::vector<std::uint32_t> rectangle_indices() {
        std::vector<std::uint32_t> list;
        list.reserve(6 * batch_strokes);
        for (std::uint32_t i = 0; i < batch_strokes; ++i)
            for (const std::uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u}) list.push_back(4 * i + corner);
        return list;
    }

    Program program_;
    Buffer buffer_, indices_;
    VertexArray array_;
    std::vector<Stroke> corners_;
    bool lightens_ = false;
};

/// The picture, part by part.
class Figure {
  public:
    explicit Figure(const MeshPicture& picture)
        : picture_(picture),
          view_(make_mesh_view(picture)),
          shades_(vertex_shades(picture, view_)),
          colors_(picture),
          strokes_(mesh_strokes(picture, view_)),
          legend_(make_legend(picture, view_, colors_, strokes_.has_curve)) {
        float span = 1;
        for (const glm::vec3& p : view_.places) span = std::max(span, std::abs(p.z));
        depth_span_ = 2.1f * span + 16;
        for (int value = 0; value < 256; ++value) palette_[static_cast<std::size_t>(value)] = colors_.of(value);
    }

    /// Beyond the roundings of triangles whose corners lie on a line.
    bool has_area() const {
        const float least = 1e-6f * static_cast<float>(std::max(picture_.width, picture_.height));
        return std::ranges::any_of(picture_.triangles, [&](const auto& t) {
            const Footprint f = footprint(view_, t);
            return f.shown && f.height > least;
        });
    }

    void draw(const PicturePart& part, planet::Image& image) {
        const int samples = std::min(4, gl().limits.samples);
        if (!target_ || target_.width() != part.width || target_.height() != part.height)
            target_ = Framebuffer(part.width, part.height, {.samples = samples});
        target_.bind();
        const glm::vec3 paper = rgb(figure_color::paper);
        target_.clear(paper.r, paper.g, paper.b, 1);
        for (Program* program : {&fills_.program(), &lines_.program()}) {
            program->set("part", glm::vec4(part.x, part.y, 2.0 / part.width, 2.0 / part.height));
            program->set("depth_span", depth_span_);
        }
        draw_mesh(part);
        draw_legend(part);
        copy_part(part, image);
    }

  private:
    void draw_mesh(const PicturePart& part) {
        if (picture_.window) limit_to_plot(part);
        if (picture_.planet) gl().Enable(GL_DEPTH_TEST);
        fills_.program().set("widest", static_cast<float>(1.15 * view_.line_unit));
        fills_.program().set("ink", rgb(figure_color::ink));
        for (std::size_t i = 0; i < picture_.triangles.size(); ++i) add_triangle(i, part);
        fills_.flush();
        gl().DepthMask(GL_FALSE);
        lines_.program().set("lift", static_cast<float>(2 * view_.line_unit));
        add_strokes(strokes_.list, part);
        gl().DepthMask(GL_TRUE);
        gl().Disable(GL_SCISSOR_TEST);
        gl().Disable(GL_DEPTH_TEST);
    }

    void add_triangle(std::size_t i, const PicturePart& part) {
        const auto& t = picture_.triangles[i];
        const glm::vec3 &a = view_.places[t[0]], &b = view_.places[t[1]], &c = view_.places[t[2]];
        if (outside(part, glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))) || !footprint(view_, t).shown)
            return;
        const Color color = palette_[picture_.step.empty() ? picture_.level[i] : picture_.step[i]];
        const auto corner = [&](std::uint32_t v) {
            return FillCorner{view_.places[v], shades_.empty() ? color : shaded(color, shades_[v])};
        };
        fills_.add(corner(t[0]), corner(t[1]), corner(t[2]));
    }

    void add_strokes(const std::vector<Stroke>& strokes, const PicturePart& part) {
        gl().Enable(GL_BLEND);
        for (const Stroke& s : strokes) {
            const float reach = 0.5f * s.width + 1;
            if (!outside(part, glm::vec2(glm::min(s.a, s.b)) - reach, glm::vec2(glm::max(s.a, s.b)) + reach))
                lines_.add(s);
        }
        lines_.flush();
        gl().BlendEquation(GL_FUNC_ADD);
        gl().Disable(GL_BLEND);
    }

    void draw_legend(const PicturePart& part) {
        for (std::size_t i = 0; i + 2 < legend_.swatches.size(); i += 3)
            fills_.add(legend_.swatches[i], legend_.swatches[i + 1], legend_.swatches[i + 2]);
        fills_.flush();
        lines_.program().set("lift", 0.0f);
        add_strokes(legend_.strokes, part);
    }

    void limit_to_plot(const PicturePart& part) const {
        const auto px = [](float v) { return static_cast<GLint>(std::lround(v)); };
        gl().Enable(GL_SCISSOR_TEST);
        gl().Scissor(px(view_.plot.left) - part.x, part.y + part.height - px(view_.plot.bottom),
                     px(view_.plot.right) - px(view_.plot.left), px(view_.plot.bottom) - px(view_.plot.top));
    }

    void copy_part(const PicturePart& part, planet::Image& image) {
        const std::vector<std::uint8_t> pixels = target_.read_rgba8();
        const std::uint8_t* from = pixels.data();
        for (int y = 0; y < part.height; ++y) {
            std::uint8_t* to = image.pixels.data() + static_cast<std::size_t>(part.y + y) * image.row_size() +
                               static_cast<std::size_t>(part.x) * 3;
            for (int x = 0; x < part.width; ++x, from += 4, to += 3) std::copy_n(from, 3, to);
        }
    }

    const MeshPicture& picture_;
    MeshView view_;
    std::vector<float> shades_;
    MeshColors colors_;
    std::array<Color, 256> palette_{};
    MeshStrokes strokes_;
    Legend legend_;
    float depth_span_ = 1;
    FillPass fills_;
    StrokePass lines_;
    Framebuffer target_;
};

}  // namespace

std::optional<MeshWindow> merging_window(const MeshPicture& picture) {
    glm::dvec3 low(0), high(0);
    bool found = false;
    for (std::size_t i = 0; i < picture.step.size(); ++i) {
        if (picture.step[i] == 0) continue;
        for (const std::uint32_t v : picture.triangles[i]) {
            const glm::dvec3& p = picture.vertices[v];
            low = found ? glm::min(low, p) : p;
            high = found ? glm::max(high, p) : p;
            found = true;
        }
    }
    if (!found) return {};
    const glm::dvec3 size = high - low;
    const double y_per_x = picture.metres_per_unit.y / picture.metres_per_unit.x;
    const double half = picture.planet ? 0.5 * glm::length(size) : 0.5 * std::max(size.x, size.y * y_per_x);
    return MeshWindow{low + 0.5 * size, 1.25 * half};
}

planet::Image draw_mesh_picture(const MeshPicture& picture) {
    check(picture);
    planet::Image image{picture.width, picture.height, 3, {}};
    Figure figure(picture);
    if (!figure.has_area()) throw planet::Error(planet::Fault::bad_data, where, "no triangle has any area");
    set_reversed_depth();
    gl().Disable(GL_DEPTH_TEST);
    image.pixels.resize(image.row_size() * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; y += part_side)
        for (int x = 0; x < image.width; x += part_side)
            figure.draw({x, y, std::min(part_side, image.width - x), std::min(part_side, image.height - y)}, image);
    require_gl("draw_mesh_picture");
    return image;
}

}  // namespace render
