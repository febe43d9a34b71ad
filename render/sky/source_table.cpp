// The tables that depend on the air alone: transmittance to the sun, multiple scattering, light on the ground.

#include <array>
#include <cassert>

#include "render/sky/air_profile.h"

namespace render {
namespace {

using glm::dvec3;
constexpr double pi = std::numbers::pi;

/// A grid of colours over (sun coordinate, height), bilinear.
struct Grid {
    int width, height;
    std::vector<dvec3> values = std::vector<dvec3>(static_cast<std::size_t>(width * height));

    dvec3& at(int x, int y) { return values[static_cast<std::size_t>(y * width + x)]; }
    dvec3 lookup(double x, double y) const {
        const double fx = std::clamp(x, 0.0, 1.0) * (width - 1), fy = std::clamp(y, 0.0, 1.0) * (height - 1);
        const int ix = std::min(static_cast<int>(fx), width - 2), iy = std::min(static_cast<int>(fy), height - 2);
        const dvec3* p = &values[static_cast<std::size_t>(iy * width + ix)];
        const double wx = fx - ix, wy = fy - iy;
        return (p[0] * (1 - wx) + p[1] * wx) * (1 - wy) + (p[width] * (1 - wx) + p[width + 1] * wx) * wy;
    }
};

/// exp(-optical depth) from a height to space. The points crowd where the ray is lowest, by squares.
dvec3 transmittance(const AirProfile& profile, double height, double mu) {
    const double r = profile.ground() + height;
    const double perigee = mu < 0 ? -r * mu : 0, end = profile.to_top(r, mu);
    dvec3 depth(0);
    const auto add = [&](double length, double sign) {
        constexpr int n = 14;
        for (int i = 0; i < n; ++i) {
            const double a = double(i) / n, b = double(i + 1) / n, mid = (a + b) / 2;
            const double t = perigee + sign * length * mid * mid;
            const double radius = std::sqrt(std::max(0.0, r * r + t * t + 2 * r * mu * t));
            depth += profile.at(radius - profile.ground()).extinction * (length * (b * b - a * a));
        }
    };
    add(end - perigee, 1);
    if (perigee > 0) add(perigee, -1);
    return glm::exp(-depth);
}

/// The part of the sun's disc above the ground sphere's horizon. @param m sine of its centre's height above it
double visible_part(double m, double angular_radius) {
    const double x = std::clamp(m / angular_radius, -1.0, 1.0);
    return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / pi;
}

class Maker {
  public:
    explicit Maker(const Atmosphere& air) : air_(air), profile_(air) {}

    AtmosphereTables make() {
        make_sunlight();
        make_multiple();
        AtmosphereTables tables;
        tables.air = air_;
        fill_source(tables);
        fill_light(tables);
        return tables;
    }

  private:
    static constexpr int multiple_suns = 32, multiple_heights = 16, sky_suns = 64, sky_heights = 4;

    double height_at(double y) const { return air_.thickness * y * y; }
    double row_at(double height) const { return std::sqrt(std::clamp(height / air_.thickness, 0.0, 1.0)); }

    void make_sunlight() {
        for (int y = 0; y < source_heights; ++y) {
            const double height = height_at(double(y) / (source_heights - 1)), dip = profile_.dip(height);
            for (int x = 0; x < sun_steps; ++x) {
                const double mu = sun_cosine(double(x) / (sun_steps - 1), dip);
                const double part = visible_part(mu + dip, air_.sun_angular_radius);
                sunlight_.at(x, y) = part > 0 ? transmittance(profile_, height, std::max(mu, -dip)) * part : dvec3(0);
            }
        }
    }

    dvec3 sunlight(double height, double mu) const {
        return sunlight_.lookup(sun_coordinate(mu, profile_.dip(height)), row_at(height));
    }

    struct Gathered {
        dvec3 light{0};  ///< radiance of the first order, or of all of them
        dvec3 again{0};  ///< what part of an isotropic light of radiance 1 comes back
    };

    /// Along a ray from (height, mu); sun_mu is the sun's cosine there and nu that of the ray and the sun.
    template <typename Source>
    Gathered gather(double height, double mu, double sun_mu, double nu, int steps, Source source) const {
        const double r = profile_.ground() + height;
        const double disc = r * r * mu * mu + profile_.ground() * profile_.ground() - r * r;
        const bool ground = mu < 0 && disc > 0;
        const double length = ground ? profile_.to_ground(r, mu) : profile_.to_top(r, mu);
        Gathered sum;
        dvec3 through(1);
        for (int i = 0; i < steps; ++i) {
            const double a = double(i) / steps, b = double(i + 1) / steps;
            const double t = length * (a * a + b * b) / 2, dt = length * (b * b - a * a);
            const double radius = std::sqrt(std::max(0.0, r * r + t * t + 2 * r * mu * t));
            const double h = std::clamp(radius - profile_.ground(), 0.0, air_.thickness);
            const AirSample s = profile_.at(h);
            const dvec3 step = glm::exp(-s.extinction * dt);
            const dvec3 weight = through * (dvec3(1) - step) / glm::max(s.extinction, dvec3(1e-30));
            sum.light += weight * source(s, h, (r * sun_mu + t * nu) / radius);
            sum.again += weight * (s.rayleigh + s.mie);
            through *= step;
        }
        if (ground) {
            const double cosine = (r * sun_mu + length * nu) / profile_.ground();
            sum.light += through * sunlight(0, cosine) * (air_.ground_albedo / pi * std::max(cosine, 0.0));
        }
        return sum;
    }

    /// Hillaire 2020, equations 5 to 10: the second order with isotropic phase, times the geometric series.
    dvec3 multiple_at(double height, double sun_mu) const {
        constexpr int zeniths = 8, azimuths = 4;
        const double sun_side = std::sqrt(std::max(0.0, 1 - sun_mu * sun_mu));
        dvec3 second(0), again(0);
        for (int i = 0; i < zeniths; ++i) {
            const double mu = 1 - (2 * i + 1.0) / zeniths, side = std::sqrt(1 - mu * mu);
            for (int j = 0; j < azimuths; ++j) {
                const double nu = mu * sun_mu + side * sun_side * std::cos(pi * (j + 0.5) / azimuths);
                const Gathered g = gather(height, mu, sun_mu, nu, 12, [&](const AirSample& s, double h, double m) {
                    return sunlight(h, m) * (s.rayleigh + s.mie) / (4 * pi);
                });
                second += g.light / double(zeniths * azimuths);
                again += g.again / double(zeniths * azimuths);
            }
        }
        return second / (dvec3(1) - glm::min(again, dvec3(0.95)));
    }

    void make_multiple() {
        for (int y = 0; y < multiple_heights; ++y) {
            const double height = height_at(double(y) / (multiple_heights - 1)), dip = profile_.dip(height);
            for (int x = 0; x < multiple_suns; ++x)
                multiple_.at(x, y) = multiple_at(height, sun_cosine(double(x) / (multiple_suns - 1), dip));
        }
    }

    dvec3 multiple(double height, double mu) const {
        return multiple_.lookup(sun_coordinate(mu, profile_.dip(height)), row_at(height));
    }

    /// Irradiance of the sky on a level plane.
    dvec3 skylight_at(double height, double sun_mu) const {
        constexpr int zeniths = 6, azimuths = 5;
        const double sun_side = std::sqrt(std::max(0.0, 1 - sun_mu * sun_mu));
        dvec3 sum(0);
        for (int i = 0; i < zeniths; ++i) {
            const double mu = std::sqrt((i + 0.5) / zeniths), side = std::sqrt(1 - mu * mu);  // even in mu d(mu)
            for (int j = 0; j < azimuths; ++j) {
                const double nu = mu * sun_mu + side * sun_side * std::cos(pi * (j + 0.5) / azimuths);
                const double rayleigh = rayleigh_phase(nu), mie = mie_phase(nu, air_.mie_asymmetry);
                sum += gather(height, mu, sun_mu, nu, 12, [&](const AirSample& s, double h, double m) {
                           return sunlight(h, m) * (s.rayleigh * rayleigh + s.mie * mie) +
                                  multiple(h, m) * (s.rayleigh + s.mie);
                       }).light;
            }
        }
        return sum * (pi / (zeniths * azimuths));
    }

    void fill_source(AtmosphereTables& tables) const {
        tables.source.resize(std::size_t{source_heights} * sun_steps);
        AirSource* out = tables.source.data();
        for (int y = 0; y < source_heights; ++y)
            for (int x = 0; x < sun_steps; ++x, ++out) {
                const dvec3 sun = sunlight_.values[static_cast<std::size_t>(y * sun_steps + x)];
                const dvec3 many = multiple_.lookup(double(x) / (sun_steps - 1), double(y) / (source_heights - 1));
                for (int c = 0; c < 3; ++c) {
                    out->sun[c] = static_cast<float>(sun[c]);
                    out->multiple[c] = static_cast<float>(many[c]);
                }
                out->sun[3] = out->multiple[3] = 0;
            }
    }

    void fill_light(AtmosphereTables& tables) const {
        constexpr double range = 12500;
        Grid sky{sky_suns, sky_heights};
        for (int y = 0; y < sky_heights; ++y) {
            const double height = range * y / (sky_heights - 1), dip = profile_.dip(height);
            for (int x = 0; x < sky_suns; ++x)
                sky.at(x, y) = skylight_at(height, sun_cosine(double(x) / (sky_suns - 1), dip));
        }
        tables.sun_light = tables.sky_light = {sun_steps, ground_heights, 1, {}};
        for (int y = 0; y < ground_heights; ++y)
            for (int x = 0; x < sun_steps; ++x) {
                const double u = double(x) / (sun_steps - 1), v = double(y) / (ground_heights - 1);
                tables.sun_light.texels.emplace_back(sunlight_.lookup(u, row_at(range * v)), 0.0);
                tables.sky_light.texels.emplace_back(sky.lookup(u, v), 0.0);
            }
    }

    Atmosphere air_;
    AirProfile profile_;
    Grid sunlight_{sun_steps, source_heights};
    Grid multiple_{multiple_suns, multiple_heights};
};

}  // namespace

Atmosphere Atmosphere::none(double equatorial_radius, double polar_radius) {
    Atmosphere air;
    air.equatorial_radius = equatorial_radius;
    air.polar_radius = polar_radius;
    air.rayleigh = air.ozone = dvec3(0);
    air.mie_scattering = air.mie_extinction = 0;
    return air;
}

AtmosphereTables make_tables(const Atmosphere& air) {
    assert(air.equatorial_radius > air.depth_below && air.polar_radius > 0 && air.thickness > 0);
    return Maker(air).make();
}

}  // namespace render
