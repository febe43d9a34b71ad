#pragma once
// The area of the ground within rings of geodesics: of the ellipsoid by Karney's closed form, of the terrain by its cells.

#include <functional>
#include <vector>

#include "planet/geodesy/geodesic.h"
#include "planet/terrain/ground.h"

namespace planet {

/// Closed rings, the first corner not repeated. What lies within an odd number of them is inside: holes and islands may
/// be listed in any order and turn either way. The inside of a ring is the smaller of its two sides.
using Rings = std::vector<std::vector<Geodetic>>;

/// Square metres.
struct GroundArea {
    double area = 0;
    /// How far `area` can be from that of the store's surface, but for 1e-6 of it: from cells where rings bend or meet.
    double bound = 0;
    std::size_t cells = 0;  ///< of the ground, those that a ring passes through in part
};

/// The area of the store's surface over what is inside. Every ring has at least 3 corners; latitudes in [-pi/2, pi/2],
/// all finite; sides are shortest lines, shorter than half a turn. Rings that cross themselves are taken as they are, by parity.
/// @param progress told the share of the planet that is done, 0..1; may be empty
GroundArea ground_area(const StoreField& field, const Rings& rings, const std::function<void(double)>& progress = {});

}  // namespace planet
