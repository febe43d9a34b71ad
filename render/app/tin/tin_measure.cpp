#include "render/app/tin/tin_measure.h"

#include <cassert>

#include "render/app/tin/tin_gpu_measure.h"

namespace render {

planet::TinMetric TinMeasureChoice::in_tiles() const {
    assert(goes_in_tiles());
    if (metric == TinMetricName::regional) return planet::TinMetric::regional;
    return metric == TinMetricName::rms ? planet::TinMetric::rms : planet::TinMetric::local;
}

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
