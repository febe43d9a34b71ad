#pragma once
// How much a triangle deviates from the samples in it, and which of them should be inserted: what orders greedy
// insertion.

#include <memory>
#include <span>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"
#include "planet/tin/triangle_scan.h"

namespace planet {

struct Measured {
    double priority =
        0;  ///< triangles of the largest are refined first; of equal ones that of the first sample in rows
    double deviation = 0;   ///< the largest vertical distance of a valid sample in it, metres
    glm::ivec2 sample{-1};  ///< to insert: at no vertex; -1 if there is none, or the deviation is 0
};

class TinMeasure {
  public:
    virtual ~TinMeasure() = default;
    /// Measures triangles after the triangulation has changed: all at first, then those that an insertion has made.
    /// Void samples count for nothing. @param out of the same length as triangles
    virtual void measure(const Delaunay& mesh, std::span<const Delaunay::Index> triangles, std::span<Measured> out) = 0;
    /// Whether deviations are those of every sample, exactly. If not, what is made with it has to be measured again.
    virtual bool exact() const { return true; }
    /// Whether the priorities of all triangles add up to what a triangulation is judged by. If not, it is judged by the
    /// largest deviation, and that is the priority.
    virtual bool adds_up() const { return false; }
    /// Of any triangle, for a measure that adds up.
    virtual double priority(const SortedTriangle&) const { return 0; }
};

enum class TinMetric {
    local,     ///< the largest vertical distance
    regional,  ///< the distances of all samples of a triangle together, m: its worst sample goes in
    rms,       ///< their squares together, m^2: its worst sample goes in
};

/// @param grid stays as long as the measure
std::unique_ptr<TinMeasure> make_measure(TinMetric metric, const HeightGrid& grid);
/// The same of a tile, whose border stays as it is: no sample on the grid's border is one to insert, and deviations are
/// those of the others.
std::unique_ptr<TinMeasure> make_inner_measure(TinMetric metric, const HeightGrid& grid);

}  // namespace planet
