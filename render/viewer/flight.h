#pragma once
// A flight from one view to another: out, across and in again, the smoothest way for the eye. After van Wijk and Nuij,
// "Smooth and efficient zooming and panning" (2003): of all paths in ground distance u and range w, the one along which
// the picture flows least.

#include <glm/glm.hpp>

#include "render/viewer/camera.h"

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
    double ground_m_ = 0;         ///< between the places
    double r0_ = 0, length_ = 0;  ///< of van Wijk and Nuij's path
};

}  // namespace render
