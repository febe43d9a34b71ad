#include "render/passes/tin_deviation.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "planet/error.h"
#include "render/gl/checks.h"

namespace render {

using planet::Delaunay;
using planet::Measured;

namespace {

constexpr int margin = 1;  ///< pixels around the raster
/// Floats hold whole numbers up to there.
constexpr std::uint32_t number_end = 1u << 24;

Framebuffer make_target(const planet::HeightGrid& grid, GLenum format) {
    return {grid.width() + 2 * margin, grid.height() + 2 * margin, {.color_format = format}};
}

void require_drawable(const planet::HeightGrid& grid) {
    const int most = std::min(gl().limits.target_size, gl().limits.texture_size) - 2 * margin;
    if (grid.width() <= most && grid.height() <= most) return;
    throw planet::Error(planet::Fault::bad_usage, "the gpu measure",
                        std::to_string(grid.width()) + "x" + std::to_string(grid.height()) + " samples",
                        "at most " + std::to_string(most) + "x" + std::to_string(most));
}

}  // namespace

TinDeviation::TinDeviation(const planet::HeightGrid& grid) : grid_(grid) {
    require_drawable(grid);
    raster_program_ = Program::link({"full_screen.vert.glsl", "tin_raster.frag.glsl"});
    deviation_program_ = Program::link({"tin_deviation.vert.glsl", "tin_deviation.frag.glsl"});
    raster_ = make_target(grid, GL_R8);
    deviation_ = make_target(grid, GL_RG32F);
    no_vertices_ = VertexArray::create();
    array_ = VertexArray::create();
    draw_raster();
    deviation_.clear(0, 0, 0, 0);
    deviation_program_.set("size", glm::ivec2(deviation_.width(), deviation_.height()));
    deviation_program_.set("margin", margin);
    deviation_program_.set("raster_depth", 0);
    deviation_program_.set("metres", static_cast<float>(2 * range_));
    require_gl("TinDeviation");
}

float TinDeviation::normalized(float height) const {
    return static_cast<float>((static_cast<double>(height) - lowest_) / range_);
}

// Heights are the upper half of all depths, where steps are even: 2^-24 each.
void TinDeviation::draw_raster() {
    float lowest = std::numeric_limits<float>::max(), highest = std::numeric_limits<float>::lowest();
    for (int y = 0; y < grid_.height(); ++y)
        for (int x = 0; x < grid_.width(); ++x) {
            if (!grid_.valid({x, y})) continue;
            lowest = std::min(lowest, grid_.at({x, y}));
            highest = std::max(highest, grid_.at({x, y}));
        }
    lowest_ = static_cast<double>(lowest);
    if (highest > lowest) range_ = static_cast<double>(highest) - lowest_;
    depth_step_ = 2 * range_ * 0x1p-24;

    Texture heights = Texture::make_2d(GL_R32F, grid_.width(), grid_.height());
    std::vector<float> row(static_cast<std::size_t>(grid_.width()));
    for (int y = 0; y < grid_.height(); ++y) {
        for (int x = 0; x < grid_.width(); ++x)
            row[static_cast<std::size_t>(x)] = grid_.valid({x, y}) ? normalized(grid_.at({x, y})) : -1;
        heights.upload_box(0, 0, y, 0, grid_.width(), 1, 1, bytes_of(row));
    }
    raster_.bind();
    raster_.clear(0, 0, 0, 0);
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_ALWAYS);
    gl().DepthMask(GL_TRUE);
    gl().Enable(GL_SCISSOR_TEST);
    gl().Scissor(margin, margin, grid_.width(), grid_.height());
    raster_program_.use();
    raster_program_.set("heights", 0);
    raster_program_.set("margin", margin);
    heights.bind(0);
    no_vertices_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    gl().Disable(GL_SCISSOR_TEST);
}

void TinDeviation::measure(const Delaunay& mesh, std::span<const Delaunay::Index> triangles, std::span<Measured> out) {
    std::ranges::fill(out, Measured{});
    if (first_number_ + triangles.size() > number_end) {
        deviation_.clear(0, 0, 0, 0);
        first_number_ = 1;
    }
    if (triangles.size() >= number_end)
        throw planet::Error(planet::Fault::bad_usage, "the gpu measure",
                            std::to_string(triangles.size()) + " triangles at once",
                            "fewer than " + std::to_string(number_end));
    const Window window = collect(mesh, triangles);
    if (vertices_.empty()) return;
    draw(window);
    read(window, mesh, triangles, out);
    first_number_ += static_cast<std::uint32_t>(triangles.size());
}

TinDeviation::Window TinDeviation::collect(const Delaunay& mesh, std::span<const Delaunay::Index> triangles) {
    Window window;
    vertices_.clear();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto [a, b, c] = mesh.corners(triangles[i]);
        if (!grid_.valid(a) || !grid_.valid(b) || !grid_.valid(c)) continue;
        Vertex vertex{a, a, b, c, {}, static_cast<float>(first_number_ + i)};
        vertex.heights = {normalized(grid_.at(a)), normalized(grid_.at(b)), normalized(grid_.at(c))};
        for (const glm::ivec2 p : {a, b, c}) {
            window.low = glm::min(window.low, p);
            window.high = glm::max(window.high, p);
            vertex.place = p;
            vertices_.push_back(vertex);
        }
        add_beyond_border(mesh, triangles[i], vertex);
    }
    return window;
}

void TinDeviation::add_beyond_border(const Delaunay& mesh, Delaunay::Index triangle, Vertex vertex) {
    for (Delaunay::Index e = 3 * triangle; e < 3 * triangle + 3; ++e) {
        if (mesh.twin(e) != Delaunay::none) continue;
        const glm::ivec2 p = mesh.point(mesh.origin(e)), q = mesh.point(mesh.origin(Delaunay::next(e)));
        const glm::ivec2 along = glm::sign(q - p), out(along.y, -along.x);  // the triangle lies to the left
        for (const glm::ivec2 place : {p, q, q + out, p, q + out, p + out}) {
            vertex.place = place;
            vertices_.push_back(vertex);
        }
    }
}

void TinDeviation::draw(const Window& window) {
    const auto bytes = bytes_of(vertices_);
    if (bytes.size() > buffer_.size()) {
        buffer_ = Buffer(std::max(2 * bytes.size(), std::size_t{1} << 14));
        using enum Attribute::Conversion;
        const auto places = [](GLuint location, std::size_t offset) {
            return Attribute{location, 2, GL_INT, static_cast<GLuint>(offset), integer};
        };
        const Attribute attributes[] = {places(0, offsetof(Vertex, place)),
                                        places(1, offsetof(Vertex, a)),
                                        places(2, offsetof(Vertex, b)),
                                        places(3, offsetof(Vertex, c)),
                                        {4, 3, GL_FLOAT, offsetof(Vertex, heights)},
                                        {5, 1, GL_FLOAT, offsetof(Vertex, number)}};
        array_.set_vertices(0, buffer_, sizeof(Vertex), attributes);
    }
    buffer_.upload(bytes);

    gl().Enable(GL_SCISSOR_TEST);
    const glm::ivec2 size = window.high - window.low + 1;
    gl().Scissor(window.low.x + margin, window.low.y + margin, size.x, size.y);
    gl().Disable(GL_CULL_FACE);
    gl().Disable(GL_BLEND);
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_ALWAYS);
    gl().DepthMask(GL_TRUE);
    deviation_.bind();
    deviation_program_.use();
    raster_.depth().bind(0);
    array_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
    gl().Disable(GL_SCISSOR_TEST);
    check_gl("TinDeviation::draw");
}

// Row 0 of the raster is the lowest of the picture: samples come in rows.
void TinDeviation::read(const Window& window, const Delaunay& mesh, std::span<const Delaunay::Index> triangles,
                        std::span<Measured> out) {
    const glm::ivec2 size = window.high - window.low + 1;
    pixels_.resize(2 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    gl().ReadPixels(window.low.x + margin, window.low.y + margin, size.x, size.y, GL_RG, GL_FLOAT, pixels_.data());
    require_gl("TinDeviation::read");
    const double least = steps_off * depth_step_;
    const float* pixel = pixels_.data();
    for (int y = window.low.y; y <= window.high.y; ++y)
        for (int x = window.low.x; x <= window.high.x; ++x, pixel += 2) {
            const double deviation = static_cast<double>(pixel[0]);
            const std::size_t i = static_cast<std::uint32_t>(pixel[1]) - first_number_;
            if (deviation <= least || i >= triangles.size() || deviation <= out[i].deviation) continue;
            const auto corners = mesh.corners(triangles[i]);
            if (std::ranges::find(corners, glm::ivec2(x, y)) == corners.end()) out[i] = {deviation, deviation, {x, y}};
        }
}

}  // namespace render
