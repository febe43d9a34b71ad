#include "render/app/tin/tin_measure.h"

#include "render/app/tin/tin_gpu_measure.h"

namespace render {

std::unique_ptr<planet::TinMeasure> make_tin_measure(const TinMeasureChoice& choice, const planet::HeightGrid& grid) {
    switch (choice.metric) {
        case TinMetricName::regional:
            return planet::make_measure(planet::TinMetric::regional, grid);
        case TinMetricName::rms:
            return planet::make_measure(planet::TinMetric::rms, grid);
        case TinMetricName::gpu:
            return make_gpu_measure(grid);
        case TinMetricName::local:
            break;
    }
    if (choice.locate == TinLocateName::cells) return planet::make_error_grid_measure(grid, planet::LocateWay::cells);
    if (choice.locate == TinLocateName::naive) return planet::make_error_grid_measure(grid, planet::LocateWay::naive);
    return nullptr;
}

}  // namespace render
