#pragma once
// Greedy insertion in strict order, under any measure, to a deviation or a budget of triangles, from the four corners
// of a raster. (Garland and Heckbert, "Fast polygonal approximation of terrains and height fields"; Raudins' iterative
// TIN.)
//
// A budget does not end in the last state but in the best on the way, as an insertion can make things worse before they
// get better. What the budget then has left goes to samples that make nothing worse.

#include <functional>
#include <limits>

#include "planet/tin/measure.h"
#include "planet/tin/tin_mesh.h"

namespace planet {

/// A state on the way to the budget, for pictures.
struct TinStage {
    std::size_t asked = 0;  ///< the number of triangles that was asked for: there are as many, or up to two fewer
    TinMesh mesh;           ///< after the last insertion
    std::vector<float> deviation;  ///< before it, by sample in rows, metres; NaN where void or in no triangle
    glm::ivec2 inserted{0};        ///< the sample inserted
    double deviation_max = 0;      ///< before it, metres
};

struct GreedyOptions {
    /// Ends when no sample deviates by more, metres, >= 0.
    double tolerance = 0;
    /// Ends before there are more triangles, at least 2.
    std::size_t max_triangles = std::numeric_limits<std::size_t>::max();
    TinMeasure* measure = nullptr;  ///< none: local
    /// Triangles of no more than that are not refined, however far their samples: by the measure, >= 0.
    double least_priority = 0;
    std::vector<std::size_t> stages = {};
    std::function<void(TinStage&&)> at_stage = {};
};

enum class GreedyEnd {
    tolerance,  ///< every sample is within the tolerance
    budget,     ///< another insertion would have made too many triangles
};

struct GreedyReport {
    GreedyEnd end = GreedyEnd::tolerance;
    std::size_t triangles = 0;
    std::size_t insertions = 0;  ///< by greedy order, of which
    std::size_t taken_back = 0;  ///< so many, to return to the best state
    std::size_t filled_up = 0;   ///< and so many made after that, which make nothing worse
    double deviation_max = 0;    ///< metres, exactly measured
};

/// Refines a triangulation of the whole grid that has void_border() as vertices and of which no vertex was removed.
/// Throws Error(bad_usage) if it has more triangles than the budget before any insertion, or if the tolerance or the
/// budget is out of range.
GreedyReport insert_greedily(Delaunay& mesh, const HeightGrid& grid, const GreedyOptions& options);

/// A triangulation of a grid to start from: its corners, void_border(), and so many columns and rows that no triangle
/// is too long to be scanned.
Delaunay coarsest_tin(const HeightGrid& grid);

/// The distance of every sample from the triangle that holds it, metres, in rows; NaN where void or in no triangle.
std::vector<float> deviation_grid(const Delaunay& mesh, const HeightGrid& grid);

}  // namespace planet
