#pragma once
// What a view cannot show: outside the frustum or behind the planet.

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace planet {

struct Culling {
    glm::dvec3 eye{0};
    std::array<glm::dvec3, 4> inward{};  ///< unit normals of the side planes through the eye; zero: no plane
    double occluder_radius = 0;          ///< m: a ball about the planet's centre that no terrain lets light through

    /// For many spheres see CullingTest.
    bool hidden(const glm::dvec3& centre, double radius) const;

    friend bool operator==(const Culling&, const Culling&) = default;
};

/// Conservative: a sphere it calls hidden is hidden, whatever it holds.
class CullingTest {
  public:
    explicit CullingTest(const Culling& culling) : culling_(culling) {
        for (unsigned k = 0; k < 4; ++k)
            if (culling.inward[k] != glm::dvec3(0)) everything_ |= 1u << k;
        const double distance2 = glm::dot(culling.eye, culling.eye),
                     ball2 = culling.occluder_radius * culling.occluder_radius;
        if (distance2 <= ball2) return;
        everything_ |= horizon;
        const double distance = std::sqrt(distance2), tangent = std::sqrt(distance2 - ball2);
        to_centre_ = -culling.eye / distance;
        tangent_circle_ = tangent * tangent / distance;
        cos_cone_ = tangent / distance;
        sin_cone_ = culling.occluder_radius / distance;
    }

    /// All there is to ask: a bit for each plane and one for the horizon.
    unsigned everything() const { return everything_; }

    /// @param open what a sphere that holds this one has not passed whole, everything() to begin with; becomes what this
    /// one has not: it need not be asked of spheres within
    bool hidden(const glm::dvec3& centre, double radius, unsigned& open) const {
        if (open == 0) return false;
        const glm::dvec3 to = centre - culling_.eye;
        for (unsigned k = 0; k < 4; ++k) {
            if (!(open >> k & 1)) continue;
            const double inside = glm::dot(culling_.inward[k], to);
            if (inside < -radius) return true;
            if (inside > radius) open &= ~(1u << k);
        }
        return (open & horizon) != 0 && behind_horizon(to, radius, open);
    }

  private:
    static constexpr unsigned horizon = 16;

    // Hidden lies in the shadow of the ball seen from the eye: inside the tangent cone, and beyond the tangent circle.
    bool behind_horizon(const glm::dvec3& to, double radius, unsigned& open) const {
        const double along = glm::dot(to, to_centre_);
        if (!(along - radius > tangent_circle_)) {
            if (!(along + radius > tangent_circle_)) open &= ~horizon;
            return false;
        }
        // The sphere's far rim from the cone's axis, against the cone: sin(axis angle) + radius / |to| <= sin(cone).
        const double across = std::sqrt(std::fmax(0.0, glm::dot(to, to) - along * along));
        return across * cos_cone_ + radius <= along * sin_cone_;
    }

    Culling culling_;
    unsigned everything_ = 0;
    glm::dvec3 to_centre_{0};
    double tangent_circle_ =
        std::numeric_limits<double>::infinity();  ///< from the eye along to_centre_; in the ball: never
    double cos_cone_ = 0, sin_cone_ = 0;
};

inline bool Culling::hidden(const glm::dvec3& centre, double radius) const {
    const CullingTest test(*this);
    unsigned open = test.everything();
    return test.hidden(centre, radius, open);
}

}  // namespace planet
