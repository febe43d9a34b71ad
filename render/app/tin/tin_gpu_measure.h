#pragma once
// The gpu measure of TINs, with a context of its own.

#include <memory>

#include "render/gl/context.h"
#include "render/passes/tin_deviation.h"

namespace render {

/// A measure for planet::TinOptions. Its context is current on the thread that made it, for as long as it lives.
class GpuMeasure : public planet::TinMeasure {
  public:
    GpuMeasure(const planet::HeightGrid& grid, const ContextOptions& options)
        : context_(Context::create(options)), deviation_(grid) {}

    void measure(const planet::Delaunay& mesh, std::span<const planet::Delaunay::Index> triangles,
                 std::span<planet::Measured> out) override {
        deviation_.measure(mesh, triangles, out);
    }
    bool exact() const override { return deviation_.exact(); }

    /// Metres: see TinDeviation.
    double depth_step() const { return deviation_.depth_step(); }
    const Context& context() const { return context_; }

  private:
    Context context_;
    TinDeviation deviation_;
};

/// Throws planet::Error: no_graphics (exit status 4) without a usable context, in one line that names every way that was
/// tried; bad_usage for a raster larger than what can be drawn to.
/// @param grid stays as long as the measure
std::unique_ptr<GpuMeasure> make_gpu_measure(const planet::HeightGrid& grid, const ContextOptions& options = {});

}  // namespace render
