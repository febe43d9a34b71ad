#pragma once
// A flight from one view to another: out, across and in again, the smoothest way for the eye.

#include <glm/glm.hpp>

#include "render/viewer/camera.h"
#include "render/viewer/great_circle.h"
#include "render/viewer/zoom_pan.h"

namespace render {

/// What a view is about: a place, seen from a range, in the place's local frame.
struct Sight {
    glm::dvec3 normal{1, 0, 0};                         ///< of the place
    double h = 0;                                       ///< of the ground there, m above the ellipsoid
    double range = 1e7;                                 ///< from it to the eye, m
    double heading = 0, pitch = -90 * planet::degrees;  ///< rad, in the place's frame
};

/// The eye that looks at a place, without roll.
Pose pose_of(const Sight& sight);

class Flight {
  public:
    Flight() = default;
    Flight(const Sight& from, const Sight& to);

    /// Seconds.
    double duration() const { return duration_; }
    /// 0 to duration(): begins and ends at rest.
    Sight at(double seconds) const;

  private:
    Sight from_, to_;
    double duration_ = 0;
    GreatCircle ground_;
    ZoomPan way_;
};

}  // namespace render
