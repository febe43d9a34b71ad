#pragma once
// The deviations of a triangulation from its raster, measured by drawing: the raster to depth once, then new triangles to
// depth, with the absolute difference of both from the fragment shader; the window that an insertion has made dirty is
// read back (Raudins, "Iterative TIN").
//
// Samples are the middles of pixels, so vertices lie there too, and a sample on a side belongs to one triangle by the
// rules of rasterization. Where the raster ends, triangles are drawn one pixel beyond, lest those rules leave out the
// samples of its last row and column.

#include <cstdint>
#include <limits>

#include "planet/tin/measure.h"
#include "render/gl/buffer.h"
#include "render/gl/framebuffer.h"
#include "render/gl/shader.h"

namespace render {

/// Ranks triangles as the local measure does, to within a few depth steps. Not exact: greedy insertion ends with what
/// the local measure still finds.
class TinDeviation : public planet::TinMeasure {
  public:
    /// Draws the raster, with the context that is current on this thread and has to be for every measurement.
    /// @param grid stays as long as this
    /// Throws planet::Error: bad_usage for a raster larger than what can be drawn to, no_graphics if the driver has no
    /// memory for it: about 17 bytes a sample.
    explicit TinDeviation(const planet::HeightGrid& grid);

    void measure(const planet::Delaunay& mesh, std::span<const planet::Delaunay::Index> triangles,
                 std::span<planet::Measured> out) override;
    bool exact() const override { return false; }

    /// Between two depths that can be told apart, metres: 2^-23 of the raster's range of heights.
    double depth_step() const { return depth_step_; }
    /// Deviations are off by less than so many steps; lesser ones count as none.
    static constexpr int steps_off = 4;

  private:
    /// One of three of a triangle that is drawn, with the triangle whose depth it has.
    struct Vertex {
        glm::ivec2 place;
        glm::ivec2 a, b, c;
        glm::vec3 heights;  ///< of these, 0..1 over the raster's range
        float number;
    };
    /// Pixels.
    struct Window {
        glm::ivec2 low{std::numeric_limits<int>::max()}, high{std::numeric_limits<int>::min()};
    };

    void draw_raster();
    Window collect(const planet::Delaunay& mesh, std::span<const planet::Delaunay::Index> triangles);
    void add_beyond_border(const planet::Delaunay& mesh, planet::Delaunay::Index triangle, Vertex vertex);
    void draw(const Window& window);
    void read(const Window& window, const planet::Delaunay& mesh, std::span<const planet::Delaunay::Index> triangles,
              std::span<planet::Measured> out);
    float normalized(float height) const;

    const planet::HeightGrid& grid_;
    double lowest_ = 0, range_ = 1, depth_step_ = 0;
    Program raster_program_, deviation_program_;
    Framebuffer raster_, deviation_;
    VertexArray no_vertices_, array_;
    Buffer buffer_;
    std::vector<Vertex> vertices_;
    std::vector<float> pixels_;
    /// Of the first triangle measured. Numbers are not used twice, so what was drawn before need not be cleared.
    std::uint32_t first_number_ = 1;
};

}  // namespace render
