#pragma once
// A TIN of a raster in memory, all steps: features, insertion, pruning.
//
// A tolerance alone is met in tiles, quickly (tiled_tin.h). Budgets, other measures, features and stages go by one
// strict greedy insertion over the whole (greedy_tin.h).

#include <string>
#include <utility>

#include "planet/tin/greedy_tin.h"
#include "planet/tin/tiled_tin.h"
#include "planet/tin/tin_features.h"

namespace planet {

struct TinOptions {
    double tolerance = 0;  ///< metres, >= 0: no sample is farther, by certified measurement in double
    std::size_t max_triangles =
        std::numeric_limits<std::size_t>::max();  ///< at least 2; whichever of the two comes first
    TinQuality quality = TinQuality::standard;
    TinMetric metric = TinMetric::local;
    TinMeasure* measure = nullptr;  ///< instead of the metric: one of the caller's
    TinFeatures features = {};
    std::vector<std::size_t> stages = {};  ///< see GreedyOptions
    std::function<void(TinStage&&)> at_stage = {};
    unsigned threads = 0;  ///< 0: one a processor. The same bits whatever the number.
    /// If given, heights to go by instead of the grid's, of which memory need not hold all at once (tin_tiles()). The
    /// vertices get these, too.
    WindowReader heights = {};
};

struct TinResult {
    TinMesh mesh;
    GreedyEnd end = GreedyEnd::tolerance;
    std::size_t insertions = 0, pruned = 0;  ///< of one mesh; 0 where made in tiles
    FeatureReport features;
    std::vector<std::pair<std::string, double>> seconds;  ///< by step
};

/// Throws Error(bad_usage) for a tolerance or a budget out of range, or smaller than corners, features and voids need.
TinResult make_tin(const HeightGrid& grid, const TinOptions& options);

}  // namespace planet
