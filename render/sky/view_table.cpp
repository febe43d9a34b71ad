// The air table of one view: every row of it is a ray's elevation, marched once; the sun's azimuth is the inner loop.

#include <array>
#include <cassert>
#include <thread>

#include "render/sky/air_profile.h"

namespace render {
namespace {

using glm::dvec3;
constexpr int rows = air_ground_rows + air_sky_rows;
constexpr int substeps = 3;
constexpr int steps = (air_slices - 1) * substeps;
constexpr float source_scale = 64;  // keeps twilight out of the half floats' denormals

double smooth(double a, double b, double x) {
    const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// The eye among the spheres.
struct View {
    AirProfile profile;
    dvec3 up, side;    // sphere space, unit
    double r, sun_mu;  // the eye's radius; the sun's cosine with up
    bool outside;
    double chord;  // chord of the angle from the zenith to the horizon
    double power_below, power_above;
};

View view_of(const Atmosphere& air, const dvec3& eye, const dvec3& sun_ecef) {
    View v{AirProfile(air), {}, {}, 0, 0, false, 0, 0, 0};
    const dvec3 p = sphere_from_ecef(air, eye), sun = glm::normalize(sphere_from_ecef(air, sun_ecef));
    const double length = glm::length(p);
    v.up = length > 0 ? p / length : dvec3(0, 0, 1);
    v.r = std::max(length, v.profile.ground() + 1);
    v.sun_mu = std::clamp(glm::dot(v.up, sun), -1.0, 1.0);
    dvec3 side = sun - v.sun_mu * v.up;
    if (glm::length(side) < 1e-9) side = glm::cross(v.up, std::abs(v.up.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0));
    v.side = glm::normalize(side);
    v.outside = v.r > v.profile.top();
    const double height = v.r - v.profile.ground();
    v.chord = std::sqrt(2 * (1 + v.profile.dip(height)));
    // From low down the air begins at the eye; from space what matters lies at the end of the ray.
    const double away = smooth(5e3, 100e3, height);
    v.power_below = 0.5 + 1.5 * away;
    v.power_above = 0.5 + 0.5 * away;
    return v;
}

/// One elevation: the inverse of the elevation axis in air_ray().
struct Ray {
    double mu, enter, leave, power;
};

Ray ray_of_row(const View& v, int row) {
    const AirProfile& a = v.profile;
    Ray ray{};
    if (row < air_ground_rows) {
        const double x = 1 - double(row) / (air_ground_rows - 1);
        const double q = 1 - x * x, incidence = 1 - q * q;  // cosine at the ground
        const double sine = a.ground() / v.r * std::sqrt(1 - incidence * incidence);
        ray.mu = -std::sqrt(std::max(0.0, 1 - sine * sine));
        ray.leave = a.to_ground(v.r, ray.mu);
        ray.power = v.power_below;
    } else {
        const double x = double(row - air_ground_rows) / (air_sky_rows - 1);
        if (v.outside) {
            const double sine = (a.ground() + x * x * (a.top() - a.ground())) / v.r;
            ray.mu = -std::sqrt(std::max(0.0, 1 - sine * sine));
        } else {
            const double c = v.chord * (1 - x * x);
            ray.mu = 1 - c * c / 2;
        }
        ray.leave = a.to_top(v.r, ray.mu);
        ray.power = v.power_above;
    }
    const double disc = v.r * v.r * ray.mu * ray.mu + a.top() * a.top() - v.r * v.r;
    ray.enter = v.outside ? -v.r * ray.mu - std::sqrt(std::max(0.0, disc)) : 0;
    ray.leave = std::max(ray.leave, ray.enter + 1);
    return ray;
}

double distance_at(const Ray& ray, double u) {
    return ray.enter + (ray.leave - ray.enter) * std::pow(u, 1 / ray.power);
}

/// Optical depths of a row from where it enters the air to each slice; [0] is 0.
using Depths = std::array<dvec3, air_slices>;

/// One step along a row, the same for every azimuth.
struct Step {
    double t, radius, height;
    glm::vec3 rayleigh, mie, both;  // scattering times the air before and within the step
};

void march(const View& v, const Ray& ray, std::array<Step, steps>& path, Depths& depths) {
    dvec3 through(1), depth(0);
    depths[0] = depth;
    for (int i = 0; i < steps; ++i) {
        const double a = distance_at(ray, double(i) / steps), b = distance_at(ray, double(i + 1) / steps);
        Step& s = path[static_cast<std::size_t>(i)];
        s.t = (a + b) / 2;
        s.radius = std::sqrt(v.r * v.r + s.t * s.t + 2 * v.r * ray.mu * s.t);
        s.height = std::max(0.0, s.radius - v.profile.ground());
        const AirSample air = v.profile.at(s.height);
        const dvec3 tau = air.extinction * (b - a), step = glm::exp(-tau);
        dvec3 weight;
        for (int c = 0; c < 3; ++c)
            weight[c] = through[c] * (tau[c] > 1e-6 ? (1 - step[c]) / air.extinction[c] : b - a);
        s.rayleigh = air.rayleigh * weight;
        s.mie = air.mie * weight;
        s.both = s.rayleigh + s.mie;
        through *= step;
        depth += tau;
        if ((i + 1) % substeps == 0) depths[static_cast<std::size_t>((i + 1) / substeps)] = depth;
    }
}

/// What a picture has instead of a spectrum of its own at every texel.
struct Ratios {
    dvec3 below{1}, above{1};
    const dvec3& of_row(int row) const { return row < air_ground_rows ? below : above; }
};

/// depth_c over depth_green by least squares, weighted to where the air is clear enough to be seen through.
dvec3 fit_ratio(const std::vector<Depths>& depths) {
    dvec3 cross(0);
    double square = 0;
    for (const Depths& row : depths)
        for (const dvec3& d : row) {
            const double w = std::exp(-2 * d.g);
            cross += w * d.g * d;
            square += w * d.g * d.g;
        }
    return square > 0 ? cross / square : dvec3(1);
}

/// The sources at one height, over the sun's coordinate.
using SourceRow = std::array<AirSource, sun_steps>;

void blend_row(const AtmosphereTables& tables, double height, SourceRow& out) {
    const double y = std::sqrt(std::clamp(height / tables.air.thickness, 0.0, 1.0)) * (source_heights - 1);
    const int i = std::min(static_cast<int>(y), source_heights - 2);
    const float w = static_cast<float>(y - i);
    const AirSource* a = &tables.source[static_cast<std::size_t>(i) * sun_steps];
    const AirSource* b = a + sun_steps;
    for (std::size_t x = 0; x < sun_steps; ++x)
        for (int c = 0; c < 4; ++c) {
            out[x].sun[c] = a[x].sun[c] + (b[x].sun[c] - a[x].sun[c]) * w;
            out[x].multiple[c] = a[x].multiple[c] + (b[x].multiple[c] - a[x].multiple[c]) * w;
        }
}

/// What depends on the azimuth: the angle to the sun, and so the phases.
struct Azimuth {
    double nu;
    float rayleigh, mie;
    glm::vec3 sum;
};
using Azimuths = std::array<Azimuth, air_azimuths>;

Azimuths azimuths_of(const View& v, const Ray& ray, double g) {
    Azimuths all;
    const double side =
        std::sqrt(std::max(0.0, 1 - ray.mu * ray.mu)) * std::sqrt(std::max(0.0, 1 - v.sun_mu * v.sun_mu));
    for (int i = 0; i < air_azimuths; ++i) {
        const double x = double(i) / (air_azimuths - 1), cosine = 1 - 2 * x * x;
        const double nu = std::clamp(ray.mu * v.sun_mu + side * cosine, -1.0, 1.0);
        all[static_cast<std::size_t>(i)] = {nu, static_cast<float>(rayleigh_phase(nu)),
                                            static_cast<float>(mie_phase(nu, g)), glm::vec3(0)};
    }
    return all;
}

/// Radiance that one step scatters towards the eye. `row` are the sources at the step's height.
glm::vec3 scattered(const View& v, const Step& s, const SourceRow& row, double dip, const Azimuth& a) {
    const double mu = (v.r * v.sun_mu + s.t * a.nu) / s.radius;
    const float m = static_cast<float>(mu + dip);
    const float x = (m > 0 ? 0.25f + 0.75f * std::sqrt(std::min(m / static_cast<float>(1 + dip), 1.0f))
                           : 0.25f - 0.25f * std::sqrt(std::min(-m / 0.4f, 1.0f))) *
                    (sun_steps - 1);
    const int i = std::min(static_cast<int>(x), sun_steps - 2);
    const float w = x - static_cast<float>(i);
    const AirSource &p = row[static_cast<std::size_t>(i)], &q = row[static_cast<std::size_t>(i) + 1];
    glm::vec3 out;
    for (int c = 0; c < 3; ++c) {
        const float sun = p.sun[c] + (q.sun[c] - p.sun[c]) * w;
        const float many = p.multiple[c] + (q.multiple[c] - p.multiple[c]) * w;
        out[c] = sun * (s.rayleigh[c] * a.rayleigh + s.mie[c] * a.mie) + many * s.both[c];
    }
    return out;
}

/// Writes J and the mean extinction of one slice of a row.
void write_slice(TableImage& air, int row, int slice, const Azimuths& all, const dvec3& depth_by_ratio,
                 double extinction, const glm::vec3& sunlight) {
    glm::vec3 scale(0);
    for (int c = 0; c < 3; ++c) {
        const double absorbed = -std::expm1(-depth_by_ratio[c]);
        if (absorbed > 0) scale[c] = static_cast<float>(source_scale * double(sunlight[c]) / absorbed);
    }
    for (int i = 0; i < air_azimuths; ++i)
        air.at(i, row, slice) = glm::vec4(glm::min(all[static_cast<std::size_t>(i)].sum * scale, glm::vec3(60000.0f)),
                                          static_cast<float>(std::log(std::max(extinction * 1e6, 1e-9))));
}

class RowMaker {
  public:
    RowMaker(const AtmosphereTables& tables, const View& view, const glm::vec3& sunlight, const Ratios& ratios,
             TableImage& out)
        : tables_(tables), view_(view), sunlight_(sunlight), ratios_(ratios), out_(out) {}

    void make(int row) {
        const Ray ray = ray_of_row(view_, row);
        std::array<Step, steps> path;
        Depths depths;
        march(view_, ray, path, depths);
        Azimuths all = azimuths_of(view_, ray, tables_.air.mie_asymmetry);
        first_slice(ray, row, all);
        for (int i = 0; i < steps; ++i) {
            const Step& s = path[static_cast<std::size_t>(i)];
            const double dip = view_.profile.dip(s.height);
            blend_row(tables_, s.height, sources_);
            for (Azimuth& a : all) a.sum += scattered(view_, s, sources_, dip, a);
            if ((i + 1) % substeps != 0) continue;
            const int slice = (i + 1) / substeps;
            const double green = depths[static_cast<std::size_t>(slice)].g;
            const double length = distance_at(ray, double(slice) / (air_slices - 1)) - ray.enter;
            write_slice(out_, row, slice, all, ratios_.of_row(row) * green, green / length, sunlight_);
        }
    }

  private:
    /// The limit at no depth: the local source over the local extinction, as of one metre of air.
    void first_slice(const Ray& ray, int row, Azimuths& all) {
        const double radius = std::sqrt(view_.r * view_.r + ray.enter * ray.enter + 2 * view_.r * ray.mu * ray.enter);
        const double height = std::max(0.0, radius - view_.profile.ground());
        const AirSample air = view_.profile.at(height);
        const Step s{
            ray.enter, radius, height, air.rayleigh, glm::vec3(static_cast<float>(air.mie)), air.rayleigh + air.mie};
        blend_row(tables_, height, sources_);
        for (Azimuth& a : all) a.sum = scattered(view_, s, sources_, view_.profile.dip(height), a);
        write_slice(out_, row, 0, all, ratios_.of_row(row) * air.extinction.g, air.extinction.g, sunlight_);
        for (Azimuth& a : all) a.sum = glm::vec3(0);
    }

    const AtmosphereTables& tables_;
    const View& view_;
    glm::vec3 sunlight_;
    Ratios ratios_;
    TableImage& out_;
    SourceRow sources_;
};

Ratios ratios_of(const View& view) {
    std::vector<Depths> below, above;
    std::array<Step, steps> path;
    for (int row = 0; row < rows; row += 4)
        march(view, ray_of_row(view, row), path, (row < air_ground_rows ? below : above).emplace_back());
    return {fit_ratio(below), fit_ratio(above)};
}

SkyUniforms uniforms_of(const AtmosphereTables& tables, const View& v, const dvec3& eye, const dvec3& sun,
                        const Ratios& ratios) {
    const Atmosphere& air = tables.air;
    const double ground = v.profile.ground(), top = v.profile.top();
    constexpr double period = 131072, near_period = 128;  // 2^17 m, 2^7 m
    SkyUniforms u{};
    u.sky_up = {v.up, v.r};
    u.sky_side = {v.side, air.equatorial_radius / air.polar_radius};
    u.sky_disc = {(ground - v.r) * (ground + v.r), (top - v.r) * (top + v.r), ground, top};
    u.sky_map = {v.chord, v.outside ? 1 : 0, v.power_below, v.power_above};
    u.sky_ratio_below = {ratios.below, 1 / source_scale};
    u.sky_ratio_above = {ratios.above, 0};
    u.sky_sun = {sun, std::cos(air.sun_angular_radius)};
    u.sky_sunlight = {std::numbers::pi * dvec3(1), 7.0};
    u.sky_detail = {eye - period * glm::floor(eye / period), 9784.0};
    u.sky_exposure = {exposure_for(tables, eye, sun), 4.0, 0.003, 0.0};
    u.sky_picture = {0, 0, 1, 0.001};
    u.sky_near = {eye - near_period * glm::floor(eye / near_period), 0};
    return u;
}

}  // namespace

dvec3 sphere_from_ecef(const Atmosphere& air, const dvec3& v) {
    return {v.x, v.y, v.z * (air.equatorial_radius / air.polar_radius)};
}

ViewTable make_view_table(const AtmosphereTables& tables, const dvec3& eye, const dvec3& sun, unsigned threads) {
    assert(tables.source.size() == std::size_t{source_heights} * sun_steps);
    const View view = view_of(tables.air, eye, sun);
    const Ratios ratios = ratios_of(view);
    ViewTable result{{air_azimuths, rows, air_slices, {}}, uniforms_of(tables, view, eye, sun, ratios)};
    result.air.texels.resize(std::size_t{air_azimuths} * rows * air_slices);
    const glm::vec3 sunlight(result.uniforms.sky_sunlight);
    const int workers = static_cast<int>(std::clamp(threads, 1u, 16u));
    const auto work = [&](int first) {
        RowMaker maker(tables, view, sunlight, ratios, result.air);
        for (int row = first; row < rows; row += workers) maker.make(row);
    };
    std::vector<std::jthread> others;
    for (int i = 1; i < workers; ++i) others.emplace_back(work, i);
    work(0);
    others.clear();
    return result;
}

float exposure_for(const AtmosphereTables& tables, const dvec3& eye, const dvec3& sun) {
    const AirProfile profile(tables.air);
    const dvec3 p = sphere_from_ecef(tables.air, eye), s = glm::normalize(sphere_from_ecef(tables.air, sun));
    const double r = glm::length(p);
    if (!(r > 0)) return 1;
    // The level light under the eye, with the night's own as its floor.
    const double mu = glm::dot(p, s) / r, x = sun_coordinate(mu, profile.dip(tables.air.depth_below)) * (sun_steps - 1);
    const int i = std::min(static_cast<int>(x), sun_steps - 2);
    const auto level = [&](int k) {
        return double(tables.sky_light.at(k, 0).g) + double(tables.sun_light.at(k, 0).g) * std::max(mu, 0.0);
    };
    const double light = std::max(level(i) + (level(i + 1) - level(i)) * (x - i), 2e-4);
    const double height = std::max(r - profile.ground(), 1.0), full = 0.8;
    // Only an eye in the air gets used to dusk: from space day and night are in one picture. What brightens the ground
    // alone, which is darker than clouds and ice, may go on to where the globe is seen whole.
    const double low = 1 - smooth(30e3, 400e3, height);
    const double near = 1 - smooth(std::log(60e3), std::log(8e6), std::log(height));
    return static_cast<float>(std::pow(std::max(full / light, 1.0), 0.45 * low) * (1 + 0.45 * near));
}

}  // namespace render
