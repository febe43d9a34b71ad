#include "render/app/tin/tin_gpu_measure.h"

namespace render {

std::unique_ptr<GpuMeasure> make_gpu_measure(const planet::HeightGrid& grid, const ContextOptions& options) {
    return std::make_unique<GpuMeasure>(grid, options);
}

}  // namespace render
