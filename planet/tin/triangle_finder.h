#pragma once
// Which triangle holds a sample: ways to find it, with the same answers.

#include <memory>
#include <span>

#include "planet/tin/delaunay.h"

namespace planet {

enum class LocateWay {
    naive,  ///< one triangle after the other
    /// Raudins' spatial index: 16 x 16 cells, each with a list of the triangles whose circumcircle meets it. A triangle
    /// lies in its circle, so the one that holds a sample is in the list of the sample's cell.
    cells,
    spans,  ///< no search: the samples of each triangle that has changed, row by row
};

/// Of several triangles that hold a sample, on a side or at a vertex, the one of lowest index.
class TriangleFinder {
  public:
    virtual ~TriangleFinder() = default;
    /// Takes in what an insertion has changed, or at first all triangles.
    virtual void update(const Delaunay& mesh, std::span<const Delaunay::Index> changed) = 0;
    virtual Delaunay::Index find(const Delaunay& mesh, glm::ivec2 sample) const = 0;
};

/// Whether a triangle holds a point, its sides included.
bool holds(const Delaunay& mesh, Delaunay::Index triangle, glm::ivec2 p);

std::unique_ptr<TriangleFinder> make_naive_finder();
/// @param low, high corners of the rectangle that is divided
std::unique_ptr<TriangleFinder> make_cell_finder(glm::ivec2 low, glm::ivec2 high);

}  // namespace planet
