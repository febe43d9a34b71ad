#pragma once
// A path of geodesics through places, by the distance along it.

#include <memory>
#include <span>
#include <vector>

#include "planet/geodesy/geodesic.h"

namespace planet {

/// Shortest lines from each place to the next. Immutable, safe from several threads; cheap to copy.
class GeodesicPath {
  public:
    /// @param places at least two; latitudes in [-pi/2, pi/2], all finite: else Error(bad_usage). Two that are the same
    /// are a leg of length 0. Between antipodes one of the equally short lines is taken.
    GeodesicPath(const Geodesics& geodesics, std::span<const Geodetic> places);

    /// Metres.
    double length() const { return ends_.back(); }
    std::size_t legs() const { return ends_.size() - 1; }
    /// Where a leg begins; leg_start(legs()) is the length.
    double leg_start(std::size_t leg) const { return ends_[leg]; }

    /// @param distance_m clamped to 0..length(). The azimuth at a corner is that of the leg after it. O(log legs).
    GeodesicPoint at(double distance_m) const;
    glm::dvec3 normal_at(double distance_m) const {
        const GeodesicPoint p = at(distance_m);
        return normal_from_geodetic(p.latitude, p.longitude);
    }

  private:
    struct Lines;
    std::shared_ptr<const Lines> lines_;
    std::vector<double> ends_;
};

}  // namespace planet
