// The air against a march in double that knows nothing of the tables.
#include <gtest/gtest.h>

#include <random>

#include "planet/frames.h"
#include "render/sky/air_profile.h"
#include "render/sky/shading_reference.h"

namespace render {
namespace {

using glm::dvec3;
using planet::degrees;

const AtmosphereTables& tables() {
    static const AtmosphereTables made = make_tables();
    return made;
}

/// The eye above latitude 0..90 at a height, in ecef, exact on the ellipsoid.
dvec3 eye_at(double latitude, double longitude, double h) {
    const Atmosphere a;
    const dvec3 n = planet::normal_from_geodetic(latitude, longitude);
    const dvec3 axes(a.equatorial_radius, a.equatorial_radius, a.polar_radius);
    return axes * axes * n / std::sqrt(glm::dot(axes * axes, n * n)) + h * n;
}

/// The piece of a ray inside the air, in sphere space: to the ground sphere or to where the air ends.
struct Span {
    bool ground = false;
    double enter = 0, leave = -1;
};
Span span_of(const AirProfile& air, const dvec3& p, const dvec3& d) {
    const double b = glm::dot(p, d), r2 = glm::dot(p, p);
    const double top = b * b + air.top() * air.top() - r2, low = b * b + air.ground() * air.ground() - r2;
    if (top <= 0 || (b > 0 && r2 > air.top() * air.top())) return {};
    Span s{low > 0 && b < 0, std::max(0.0, -b - std::sqrt(top)), -b + std::sqrt(top)};
    if (s.ground) s.leave = -b - std::sqrt(low);
    return s;
}

dvec3 optical_depth(const AirProfile& air, const dvec3& p, const dvec3& d, double from, double to, int n) {
    dvec3 sum(0);
    for (int i = 0; i < n; ++i) {
        const double t = from + (to - from) * (i + 0.5) / n;
        sum += air.at(std::max(0.0, glm::length(p + t * d) - air.ground())).extinction * ((to - from) / n);
    }
    return sum;
}

/// Light of the first order of scattering, marched along the ray and from each point to the sun.
dvec3 single_scattering(const AirProfile& air, const dvec3& p, const dvec3& d, const dvec3& sun, double enter,
                        double leave, int n) {
    const double nu = glm::dot(d, sun);
    dvec3 sum(0), depth(0);
    for (int i = 0; i < n; ++i) {
        const double a = std::pow(double(i) / n, 2), b = std::pow((i + 1.0) / n, 2);
        const double t = enter + (leave - enter) * (a + b) / 2, dt = (leave - enter) * (b - a);
        const dvec3 q = p + t * d;
        const AirSample s = air.at(std::max(0.0, glm::length(q) - air.ground()));
        const Span up = span_of(air, q, sun);
        depth += s.extinction * (dt / 2);
        if (!up.ground)
            sum += glm::exp(-depth - optical_depth(air, q, sun, 0, up.leave, 60)) * dt *
                   (s.rayleigh * rayleigh_phase(nu) + s.mie * mie_phase(nu, 0.8));
        depth += s.extinction * (dt / 2);
    }
    return sum * std::numbers::pi;
}

/// Tables without multiple scattering, so that a march can say what is right.
const AtmosphereTables& single_tables() {
    static const AtmosphereTables made = [] {
        AtmosphereTables t = tables();
        for (AirSource& s : t.source)
            for (float& v : s.multiple) v = 0;
        return t;
    }();
    return made;
}

struct Case {
    double eye_latitude, h, sun_height;  ///< degrees, metres, degrees above the eye's horizontal
};

TEST(SkyAir, RadianceIsThatOfAMarchFromTheGroundToSpace) {
    const AirProfile air((Atmosphere()));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const Case& c : {Case{37, 2, 50},
                          {0, 3000, 8},
                          {60, 11000, 2},
                          {90, 60e3, 20},
                          {-30, 400e3, 30},
                          {10, 3e7, 60},
                          {-75, 5e7, 10}}) {
        const dvec3 eye = eye_at(c.eye_latitude * degrees, 0.3, c.h), up = glm::normalize(eye);
        const dvec3 east = glm::normalize(glm::cross(dvec3(0, 0, 1) + 1e-9 * dvec3(1, 0, 0), up));
        const dvec3 sun = std::sin(c.sun_height * degrees) * up + std::cos(c.sun_height * degrees) * east;
        const ViewTable view = make_view_table(single_tables(), eye, sun);
        reference::Shading shading(view.uniforms, single_tables(), view);
        const dvec3 p = sphere_from_ecef(tables().air, eye), s = glm::normalize(sphere_from_ecef(tables().air, sun));
        shading.sky_exposure.z = 0;  // the night's glow is not of the sun
        double worst = 0, brightest = 0, sum = 0, clarity = 0, limb_clarity = 0;
        int count = 0;
        for (int i = 0; i < 300; ++i) {
            dvec3 aim(uniform(random), uniform(random), uniform(random));
            const dvec3 d = c.h < 1e5 ? glm::normalize(aim) : glm::normalize(6.45e6 * glm::normalize(aim) - eye);
            const dvec3 ds = glm::normalize(sphere_from_ecef(tables().air, d));
            const Span span = span_of(air, p, ds);
            if (span.leave <= span.enter || glm::dot(d, sun) > 0.98) continue;
            const dvec3 want = single_scattering(air, p, ds, s, span.enter, span.leave, 160);
            const glm::vec3 got = shading.air_beyond(glm::vec3(d)).in_scatter;
            const double error = glm::length(dvec3(got) - want);
            // Transmittance has one shape of spectrum a picture: good to some percent where the air is clear.
            const dvec3 clear = glm::exp(-optical_depth(air, p, ds, span.enter, span.leave, 600));
            const glm::vec3 through = shading.air_beyond(glm::vec3(d)).transmittance;
            double& unclear = span.ground ? clarity : limb_clarity;
            unclear = std::max(unclear, glm::length(dvec3(through) - clear));
            worst = std::max(worst, error), sum += error;
            brightest = std::max(brightest, glm::length(want)), ++count;
        }
        ASSERT_GT(count, 40);
        EXPECT_LT(clarity, 0.10) << c.h << " m";
        EXPECT_LT(limb_clarity, 0.25) << c.h << " m";
        std::printf("%9.0f m: worst %.4f, mean %.5f of the brightest; transmittance %.3f, of the limb %.3f\n", c.h,
                    worst / brightest, sum / count / brightest, clarity, limb_clarity);
        EXPECT_LT(worst, 0.08 * brightest) << c.h << " m, sun " << c.sun_height;
        EXPECT_LT(sum / count, 0.01 * brightest) << c.h << " m, sun " << c.sun_height;
    }
}

/// A view of every kind: a list of eyes and suns that includes the poles, the axes, below ground and far away.
std::vector<std::pair<dvec3, dvec3>> views() {
    std::vector<std::pair<dvec3, dvec3>> all;
    for (const double latitude : {90.0, 0.0, -45.0})
        for (const double h : {-9000.0, 1.0, 99e3, 99501.0, 1e6, 5e7}) {
            const dvec3 eye = eye_at(latitude * degrees, 1, h);
            for (const dvec3& sun : {glm::normalize(eye), -glm::normalize(eye), dvec3(1, 0, 0)})
                all.emplace_back(eye, sun);
        }
    all.emplace_back(dvec3(0), dvec3(0, 0, 1));
    return all;
}

TEST(SkyAir, EveryViewAndDirectionIsFiniteAndPhysical) {
    for (const auto& [eye, sun] : views()) {
        const ViewTable view = make_view_table(tables(), eye, sun);
        reference::Shading shading(view.uniforms, tables(), view);
        for (const glm::vec4& t : view.air.texels) ASSERT_TRUE(std::isfinite(t.x + t.y + t.z + t.w) && t.z >= 0);
        const glm::vec3 through = shading.sun_through_air();
        std::mt19937 random(3);
        std::uniform_real_distribution<float> uniform(-1, 1);
        std::vector<glm::vec3> directions{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, glm::vec3(sun), -glm::vec3(sun)};
        if (glm::length(eye) > 0) directions.push_back(-glm::vec3(glm::normalize(eye)));
        for (int i = 0; i < 50; ++i)
            directions.push_back(glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random))));
        for (const glm::vec3& d : directions) {
            const glm::vec3 sky = shading.sky_radiance(d, through);
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(sky, glm::vec3(0))) && glm::length(sky) < 1e4f);
            for (const float distance : {0.0f, 1e-3f, 1e3f, 1e6f, 6e7f}) {
                const auto air = shading.air_to(d * distance);
                ASSERT_TRUE(glm::all(glm::greaterThanEqual(air.in_scatter, glm::vec3(0))));
                ASSERT_TRUE(glm::all(glm::lessThanEqual(air.transmittance, glm::vec3(1))));
                if (distance < 1) {
                    ASSERT_LT(glm::length(air.in_scatter), 1e-3f);
                }
            }
        }
    }
}

TEST(SkyAir, HazeGrowsWithDistanceAndIsOneAcrossTheHorizonOfTheTable) {
    const dvec3 eye = eye_at(0.7, 0.2, 2000), up = glm::normalize(eye);
    const dvec3 north = glm::normalize(glm::cross(up, dvec3(-std::sin(0.2), std::cos(0.2), 0)));
    const ViewTable view = make_view_table(tables(), eye, glm::normalize(up + north));
    reference::Shading shading(view.uniforms, tables(), view);
    const double horizon = -std::acos(1 / (1 + 2500.0 / 6.377e6));
    float before = 0;
    for (const float distance : {1e3f, 5e3f, 2e4f, 6e4f, 1.2e5f}) {
        const auto at = [&](double elevation) {
            return shading.air_to(distance * glm::vec3(std::cos(elevation) * north + std::sin(elevation) * up));
        };
        const auto below = at(horizon - 3e-4), above = at(horizon + 3e-4);
        EXPECT_LT(glm::length(below.in_scatter - above.in_scatter), 0.02f * glm::length(above.in_scatter)) << distance;
        EXPECT_LT(glm::length(below.transmittance - above.transmittance), 0.01f) << distance;
        EXPECT_GT(below.in_scatter.b, before);
        before = below.in_scatter.b;
    }
}

TEST(SkyAir, TheSameBitsForAnyNumberOfThreads) {
    const dvec3 eye = eye_at(0.5, 0.5, 5000), sun = glm::normalize(dvec3(1, 2, 0.3));
    const ViewTable one = make_view_table(tables(), eye, sun, 1), three = make_view_table(tables(), eye, sun, 3);
    EXPECT_EQ(one.air.texels, three.air.texels);
}

TEST(SkyAir, AMoonHasNone) {
    const AtmosphereTables moon = make_tables(Atmosphere::none(1737400, 1737400));
    const ViewTable view = make_view_table(moon, {1737400 + 1e5, 0, 0}, {0, 1, 0});
    reference::Shading shading(view.uniforms, moon, view);
    const auto air = shading.air_beyond({-0.3f, 0.9f, 0.1f});
    EXPECT_EQ(air.transmittance, glm::vec3(1));
    EXPECT_EQ(air.in_scatter, glm::vec3(0));
    const auto light = shading.light_at(0, 0.5f);
    EXPECT_NEAR(light.sun.g, 3.14159f, 1e-3f);
    EXPECT_EQ(shading.light_at(0, -0.3f).sun, glm::vec3(0));
}

TEST(SkyAir, SunlightReddensAndSkyTurnsBlue) {
    const ViewTable view = make_view_table(tables(), eye_at(0, 0, 1e6), {1, 0, 0});
    reference::Shading shading(view.uniforms, tables(), view);
    const auto noon = shading.light_at(0, 1), low = shading.light_at(0, 0.05f), night = shading.light_at(0, -0.3f);
    EXPECT_NEAR(noon.sun.g / 3.14159f, 0.86f, 0.03f);  // vertical optical depth 0.11 + 0.03 + 0.01
    EXPECT_GT(low.sun.r / low.sun.b, 3 * noon.sun.r / noon.sun.b);
    EXPECT_GT(noon.sky.b, 2 * noon.sky.r);
    EXPECT_EQ(night.sun, glm::vec3(0));
    EXPECT_LT(night.sky.b, 1e-3f * noon.sky.b);
    float before = 10;
    for (float c = 1; c > -0.5f; c -= 0.01f) {
        const auto light = shading.light_at(0, c);
        EXPECT_LE(light.sun.g, before + 1e-5f);
        before = light.sun.g;
    }
}

TEST(SkyAir, ExposureRisesAtDuskButNotInSpace) {
    const dvec3 low = eye_at(0, 0, 100), far = eye_at(0, 0, 1e7);
    float before = 0;
    for (int h = 90; h >= -20; h -= 2) {
        const dvec3 sun(std::sin(h * degrees), std::cos(h * degrees), 0);
        const float exposure = exposure_for(tables(), low, sun);
        EXPECT_GE(exposure, before * 0.999f) << h;
        EXPECT_LT(exposure, 100);
        EXPECT_EQ(exposure_for(tables(), far, sun), 1.0f);
        before = exposure;
    }
    EXPECT_GT(before, 10);
}

}  // namespace
}  // namespace render
