#pragma once
// By how much the eye of a flight is lifted lest it touch the ground.

#include <functional>
#include <vector>

#include "render/viewer/flight_path.h"

namespace render {

/// The flight is looked through once, finer than frames are. Where the eye would be lower than 30 m above the ground, or
/// than its keys ask for, it is lifted; a second before and after it rises and sinks evenly, so that it flies over a
/// ridge rather than up its rocks.
class FlightClearance {
  public:
    /// Height of the drawn ground, m above the ellipsoid, at a geodetic normal and an exaggeration.
    using GroundHeight = std::function<double(const glm::dvec3& normal, double exaggeration)>;

    FlightClearance(const FlightPath& path, const GroundHeight& ground);

    /// Metres, straight up. @param seconds 0 to the path's duration()
    double lift(double seconds) const;

  private:
    double step_s_ = 1;
    std::vector<double> lifts_;
};

}  // namespace render
