#pragma once
// What a view cannot show: outside the frustum or behind the planet.

#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace planet {

/// Conservative: a sphere it calls hidden is hidden, whatever it holds.
struct Culling {
    glm::dvec3 eye{0};
    std::array<glm::dvec3, 4> inward{};  ///< unit normals of the side planes through the eye; zero: no plane
    double occluder_radius = 0;          ///< m: a ball about the planet's centre that no terrain lets light through

    bool hidden(const glm::dvec3& centre, double radius) const {
        const glm::dvec3 to = centre - eye;
        for (const glm::dvec3& n : inward)
            if (glm::dot(n, to) < -radius) return true;
        return behind_horizon(to, radius);
    }

  private:
    // Hidden lies in the shadow of the ball seen from the eye: inside the tangent cone, and beyond the tangent circle.
    bool behind_horizon(const glm::dvec3& to, double radius) const {
        const double distance2 = glm::dot(eye, eye), ball2 = occluder_radius * occluder_radius;
        if (distance2 <= ball2) return false;
        const double distance = std::sqrt(distance2), tangent2 = distance2 - ball2;
        const double along = -glm::dot(to, eye) / distance;  // towards the planet's centre
        if (along - radius <= tangent2 / distance) return false;
        const double away2 = glm::dot(to, to);
        // The sphere's far rim from the cone's axis, against the cone: sin(axis angle) + radius / |to| <= sin(cone).
        const double across = std::sqrt(std::fmax(0.0, away2 - along * along));
        const double cos_cone = std::sqrt(tangent2) / distance, sin_cone = occluder_radius / distance;
        return across * cos_cone + radius <= along * sin_cone;
    }
};

}  // namespace planet
