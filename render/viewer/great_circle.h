#pragma once
// The shorter way round between two places.

#include <cmath>
#include <glm/glm.hpp>

namespace render {

/// From one unit vector to another. Of opposite ones, on one of their great circles.
class GreatCircle {
  public:
    GreatCircle() = default;
    GreatCircle(const glm::dvec3& from, const glm::dvec3& to) : from_(from) {
        angle_ = std::atan2(glm::length(glm::cross(from, to)), glm::dot(from, to));
        across_ = to - glm::dot(from, to) * from;
        if (glm::length(across_) < 1e-9 && angle_ > 1)
            across_ = glm::cross(from, std::abs(from.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0));
        const double length = glm::length(across_);
        across_ = length > 0 ? across_ / length : glm::dvec3(0);
    }

    double angle() const { return angle_; }  ///< rad
    /// @param t 0..1
    glm::dvec3 at(double t) const { return std::cos(t * angle_) * from_ + std::sin(t * angle_) * across_; }
    /// The direction of travel there, unit; 0 between equal places.
    glm::dvec3 ahead(double t) const { return std::cos(t * angle_) * across_ - std::sin(t * angle_) * from_; }

  private:
    glm::dvec3 from_{1, 0, 0}, across_{0};
    double angle_ = 0;
};

}  // namespace render
