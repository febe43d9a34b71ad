#pragma once
// The measures that `octaglobe tin` knows by name.

#include <memory>

#include "planet/tin/error_grid.h"
#include "planet/tin/measure.h"

namespace render {

enum class TinMetricName { local, regional, rms, gpu };
enum class TinLocateName { automatic, cells, naive };

struct TinMeasureChoice {
    TinMetricName metric = TinMetricName::local;
    /// How samples find their triangle: automatic is the library's own way; the others go by an error grid, with the
    /// local metric.
    TinLocateName locate = TinLocateName::automatic;

    /// Whether it is the library's own local measure, which TINs made in tiles go by.
    bool plain() const { return metric == TinMetricName::local && locate == TinLocateName::automatic; }
    /// Whether each tile can go by it for itself.
    bool goes_in_tiles() const { return metric != TinMetricName::gpu && locate == TinLocateName::automatic; }
    /// Of those that go in tiles.
    planet::TinMetric in_tiles() const;
};

/// @param grid stays as long as the measure @return null for a plain choice
/// Throws planet::Error(no_graphics) for gpu without a usable context.
std::unique_ptr<planet::TinMeasure> make_tin_measure(const TinMeasureChoice& choice, const planet::HeightGrid& grid);

}  // namespace render
