#pragma once
// Densities, phase functions and the map of the sun's height: shared by the makers of the tables.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "render/sky/atmosphere.h"

namespace render {

/// Scattering and extinction per metre at a place.
struct AirSample {
    glm::dvec3 rayleigh{0};    ///< scattering
    double mie = 0;            ///< scattering
    glm::dvec3 extinction{0};  ///< everything
};

/// The geometry of an Atmosphere in sphere space.
class AirProfile {
  public:
    explicit AirProfile(const Atmosphere& air)
        : air_(air), ground_(air.equatorial_radius - air.depth_below), top_(ground_ + air.thickness) {}

    double ground() const { return ground_; }  ///< radius of the ground sphere
    double top() const { return top_; }        ///< radius at which the air ends

    /// @param height above the ground sphere. The profiles count from the ellipsoid, and go on below it.
    AirSample at(double height) const {
        const double h = height - air_.depth_below;
        const double mie = std::exp(-h / air_.mie_scale_height);
        AirSample s;
        s.rayleigh = air_.rayleigh * std::exp(-h / air_.rayleigh_scale_height);
        s.mie = air_.mie_scattering * mie;
        s.extinction = s.rayleigh + glm::dvec3(air_.mie_extinction * mie) +
                       air_.ozone * std::max(0.0, 1.0 - std::abs(h - 25.0e3) / 15.0e3);
        return s;
    }

    /// Sine of the dip of the ground sphere's horizon seen from a height above it.
    double dip(double height) const {
        const double up = std::max(height, 0.0);
        return std::sqrt(up * (2 * ground_ + up)) / (ground_ + up);
    }
    /// Distance along a ray from radius r and zenith cosine mu to the top of the air.
    double to_top(double r, double mu) const {
        return -r * mu + std::sqrt(std::max(0.0, r * r * mu * mu + top_ * top_ - r * r));
    }
    double to_ground(double r, double mu) const {
        return -r * mu - std::sqrt(std::max(0.0, r * r * mu * mu + ground_ * ground_ - r * r));
    }

  private:
    Atmosphere air_;
    double ground_, top_;
};

/// Coordinate 0..1 of the sun's height from its cosine with the vertical: a quarter for the sun below the horizon, and
/// fine near the horizon. The same map as light_at() in atmosphere.glsl.
inline double sun_coordinate(double cosine, double dip) {
    const double m = cosine + dip;
    return m > 0 ? 0.25 + 0.75 * std::sqrt(std::min(m / (1 + dip), 1.0))
                 : 0.25 - 0.25 * std::sqrt(std::min(-m / 0.4, 1.0));
}
inline double sun_cosine(double x, double dip) {
    const double m = x > 0.25 ? (1 + dip) * std::pow((x - 0.25) / 0.75, 2) : -0.4 * std::pow((0.25 - x) / 0.25, 2);
    return std::clamp(m - dip, -1.0, 1.0);
}

inline double rayleigh_phase(double cosine) {
    return 3 / (16 * std::numbers::pi) * (1 + cosine * cosine);
}
/// Cornette and Shanks 1992.
inline double mie_phase(double cosine, double g) {
    const double base = 1 + g * g - 2 * g * cosine;
    return 3 / (8 * std::numbers::pi) * (1 - g * g) * (1 + cosine * cosine) / ((2 + g * g) * base * std::sqrt(base));
}

}  // namespace render
