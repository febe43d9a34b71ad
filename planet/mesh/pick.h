#pragma once
// A ray against the triangles that are drawn.

#include <optional>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/view.h"

namespace planet {

struct Pick {
    double distance = 0;     ///< along the ray, in lengths of its direction
    glm::dvec3 position{0};  ///< ecef, metres, on the triangle as it is drawn: exaggerated
    LocationCode cell;       ///< the triangle
    glm::dvec3 weights{0};   ///< of its corners left, right and apex: barycentric
    /// Above the store's datum, metres, linear between the corners' heights: not exaggerated, and without the sag of the
    /// triangle.
    double height = 0;
    /// Of the triangle from the finest surface, metres, certified, as it is drawn: exaggerated. 0 if it is of the finest.
    double deviation = 0;
};

/// The first triangle that a ray meets, from either side, of those that a view draws: the leaves of its split test over
/// the tiles it is drawn from. Tiles that the source has yet to load are loaded. A ray through a side or a corner meets
/// one of the triangles there. Looks at some hundreds of cells: what a ray cannot meet is passed over by its sphere.
/// @param origin ecef, metres @param direction any length > 0
std::optional<Pick> pick(const TileSource& tiles, const SplitTest& test, const glm::dvec3& origin,
                         const glm::dvec3& direction);

}  // namespace planet
