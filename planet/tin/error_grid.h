#pragma once
// The iterative TIN as Raudins describes it: the deviation of every sample in a grid, of which each insertion makes a
// part dirty; that part is measured again, then the largest value anywhere is inserted next.
// insert_greedily() makes the same TIN without a grid; this is what it is compared with, and what can be shown.

#include <memory>
#include <vector>

#include "planet/tin/measure.h"
#include "planet/tin/triangle_finder.h"

namespace planet {

class ErrorGrid {
  public:
    /// @param grid stays as long as this
    ErrorGrid(const HeightGrid& grid, LocateWay way);

    /// Measures again what lies in triangles that an insertion has made, or at first in all: the rectangle around them,
    /// or with `spans` the triangles themselves. The values are the same: exactly so for heights in whole metres, else
    /// to the last bit or so on sides, where two triangles hold a sample.
    void update(const Delaunay& mesh, std::span<const Delaunay::Index> changed);

    struct Largest {
        double deviation = 0;  ///< metres
        glm::ivec2 sample{-1};
    };
    /// The largest; of several the first in rows. Sample -1 if nothing deviates.
    Largest largest() const;
    /// Metres, in rows; 0 where void.
    const std::vector<double>& deviations() const { return deviation_; }
    std::size_t measured() const { return measured_; }  ///< samples, by all updates

  private:
    double& at(glm::ivec2 p) {
        return deviation_[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(grid_.width()) +
                          static_cast<std::size_t>(p.x)];
    }
    void measure_rectangle(const Delaunay& mesh, glm::ivec2 low, glm::ivec2 high);
    void measure_spans(const Delaunay& mesh, std::span<const Delaunay::Index> changed);

    const HeightGrid& grid_;
    std::unique_ptr<TriangleFinder> finder_;  ///< none: spans
    std::vector<double> deviation_;
    std::vector<Largest> by_row_;
    std::size_t measured_ = 0;
};

/// The local measure by an error grid that every insertion updates: for insert_greedily(), which makes the same TIN with
/// it as without. @param grid stays as long as the measure
std::unique_ptr<TinMeasure> make_error_grid_measure(const HeightGrid& grid, LocateWay way);

/// Inserts until the tolerance is kept or another insertion would make more than max_triangles.
/// @return samples measured, by all insertions
std::size_t insert_by_error_grid(Delaunay& mesh, const HeightGrid& grid, double tolerance, std::size_t max_triangles,
                                 LocateWay way);

}  // namespace planet
