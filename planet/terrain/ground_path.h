#pragma once
// The ground under a path of geodesics: samples of it, and how long it is.

#include <functional>
#include <vector>

#include "planet/geodesy/geodesic_path.h"
#include "planet/terrain/ground.h"

namespace planet {

struct PathSample {
    double distance = 0;  ///< along the ellipsoid, metres
    GeodesicPoint place{};
    Ground ground;
};

/// Evenly spaced samples, both ends included. @param count at least 2
std::vector<PathSample> sample_path(const StoreField& field, const GeodesicPath& path, std::size_t count);

/// Of the ground under the whole path: the surface of the store, not some samples of it. A source may be rougher than its
/// surface by SurfaceBound, and lengths have no bound in terms of heights.
struct PathTotals {
    double length = 0;                     ///< metres along the ground, to 1e-6 of it
    double ascent = 0, descent = 0;        ///< metres, >= 0, of the height above the datum
    double lowest = 0, highest = 0;        ///< metres above the datum
    double lowest_at = 0, highest_at = 0;  ///< metres along the path
    double bound = 0;                      ///< the largest of the ground under the path, metres; see Ground
    std::size_t pieces = 0;                ///< that the ground consists of
};

/// Goes from side to side of the cells under the path. @param progress told the share that is done, 0..1; may be empty
PathTotals measure_path(const StoreField& field, const GeodesicPath& path,
                        const std::function<void(double)>& progress = {});

}  // namespace planet
