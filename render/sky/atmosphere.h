#pragma once
// The air as tables. Nothing is marched per pixel: one fetch in a 3-D table gives sky and aerial perspective.
//
// Sphere space. The tables treat the planet as a sphere of its equatorial radius a. Positions and directions in ecef
// enter it by stretching z by a/b, which maps the ellipsoid onto that sphere; straight lines, tangents and shadow edges
// stay what they are, so the limb lies on the ellipsoid at every latitude. Lengths are wrong by at most a/b - 1 (0.34 %
// on Earth).
//
// Model: Rayleigh and Mie scattering with exponential profiles, ozone with a tent profile (Bruneton 2017's values for
// Earth), one order of scattering exact, all higher ones isotropic (Hillaire, "A Scalable and Production Ready Sky and
// Atmosphere Rendering Technique", 2020). Channels are narrow bands at 650, 545 and 465 nm,
// nearer to the primaries of sRGB than the usual 680 and 440: haze is blue over sand, not violet. No refraction: the
// ground sphere lies 500 m below the ellipsoid (below the Dead Sea, and 0.7 degrees of dip at the sea, close to the
// 0.57 degrees that refraction lifts the sun), so terrain always covers its horizon.
//
// Textures and uniforms of render/shaders/atmosphere.glsl, surface.glsl, sky.frag.glsl and stars.vert.glsl:
//
//   unit  name             from                          format        filter and wrap
//   0     air_table        ViewTable::air                RGBA32F 3-D   linear, clamp on all axes, no mips
//   1     sun_light_table  AtmosphereTables::sun_light   RGBA32F 2-D   linear, clamp, no mips
//   2     sky_light_table  AtmosphereTables::sky_light   RGBA32F 2-D   linear, clamp, no mips
//   3     noise_table      make_noise_levels             RGBA8 3-D     trilinear with mips, repeat on all axes
//   uniform block SkyBlock at binding 1, std140: ViewTable::uniforms (SkyUniforms), byte for byte
//
// (RGBA16F holds every table too, and is as fast; floats upload without a conversion. Not used from afar: 3.)
// A fragment of terrain fills SurfaceInput and writes
//     display_from_radiance(aerial(surface_radiance(s), s.view), gl_FragCoord.xy + sky_picture.xy)
// with s.footprint = length(s.view) * sky_picture.w; define FROM_AFAR when needs_close_up() says no. Set sky_picture
// for each part of a picture; the wind (sky_sunlight.w, m/s), night lights (sky_exposure.y) and the imagery's texel
// (sky_detail.w, m) may be changed too.
//
// The air table, (azimuth 64) x (elevation 96 below + 64 above the horizon) x (depth 16). Texel: rgb the mean source
// function J = in-scattered radiance / (1 - T) times 64, a the natural logarithm of the mean extinction in
// green per 1000 km (the air thins exponentially, and so is its logarithm what interpolates), both from where the ray
// enters the air to the depth of the slice. Means and not sums: they vary slowly, so few texels are enough and near
// terrain is right to first order. T = exp(-ratio * depth_green) with one fitted ratio a channel, view and half of the
// table: wrong by at most 0.1 on the way to the ground, and by more only where both are small or the ray grazes the
// ozone layer (stars and sun at the limb).
//   azimuth    x = sin(azimuth from the sun / 2); the table is symmetric
//   elevation  below: x = sqrt(1 - sin(i/2) sqrt 2), i the angle of incidence at the ground; rows run horizon last
//              above: x = sqrt(1 - c/c_h), c the chord 2 sin(zenith angle / 2), c_h that of the horizon; from outside
//              the air x = sqrt(perigee height / thickness)
//   depth      u = s^power, s the fraction of the ray's length in the air
// The halves do not blend: each is inset by half a texel.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace render {

/// What the air is made of. Lengths in metres, coefficients per metre at height 0.
struct Atmosphere {
    double equatorial_radius = 6378137.0;
    double polar_radius = 6356752.314245179;
    double depth_below = 500.0;                        ///< the ground sphere lies this far below the ellipsoid
    double thickness = 100.0e3;                        ///< the air ends this far above the ground sphere
    glm::dvec3 rayleigh{5.88e-6, 12.06e-6, 23.05e-6};  ///< A. Bucholtz 1995, 15 C
    double rayleigh_scale_height = 8000.0;
    double mie_scattering = 3.996e-6;
    double mie_extinction = 4.44e-6;
    double mie_scale_height = 1200.0;
    double mie_asymmetry = 0.8;                   ///< g of the Cornette-Shanks phase function, [0, 1)
    glm::dvec3 ozone{1.6e-6, 1.881e-6, 0.15e-6};  ///< at its peak, 25 km up, falling to 0 over 15 km
    double ground_albedo = 0.15;                  ///< for light that comes back up, [0, 1]
    double sun_angular_radius = 0.004654;         ///< rad, mean over the year

    static Atmosphere earth() { return {}; }
    /// A planet without air (Moon): every coefficient 0, with shadows as before.
    static Atmosphere none(double equatorial_radius, double polar_radius);
};

/// A table of RGBA texels, x fastest, then y, then z.
struct TableImage {
    int width = 0, height = 0, depth = 1;
    std::vector<glm::vec4> texels;

    std::size_t index(int x, int y, int z = 0) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(width) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(height) * static_cast<std::size_t>(z));
    }
    const glm::vec4& at(int x, int y, int z = 0) const { return texels[index(x, y, z)]; }
    glm::vec4& at(int x, int y, int z = 0) { return texels[index(x, y, z)]; }
};

inline constexpr int air_azimuths = 64, air_ground_rows = 96, air_sky_rows = 64, air_slices = 16;
inline constexpr int sun_steps = 128;      ///< of the sun's height above the horizon
inline constexpr int source_heights = 64;  ///< height = thickness (i / 63)^2
inline constexpr int ground_heights = 16;  ///< of the light tables: -500 m to 12 km above the ellipsoid, evenly

/// Light that air at a height receives, at unit irradiance outside.
struct alignas(32) AirSource {
    float sun[4];       ///< rgb: transmittance to the sun times its visible part
    float multiple[4];  ///< rgb: radiance of all orders above the first, the same in every direction
};

/// The tables that depend on the air alone. About 10 ms on one thread; they can also be kept in a file.
struct AtmosphereTables {
    Atmosphere air;
    std::vector<AirSource> source;  ///< source_heights rows of sun_steps
    TableImage sun_light;           ///< sun_steps x ground_heights: irradiance across the sun's rays
    TableImage sky_light;           ///< sun_steps x ground_heights: irradiance of the sky on a level plane
};

AtmosphereTables make_tables(const Atmosphere& air = Atmosphere::earth());

/// The uniform block. Its members are documented where they are declared.
struct SkyUniforms {
    using vec4 = glm::vec4;
#include "render/shaders/sky_uniforms.glsl"
};

/// What one picture needs.
struct ViewTable {
    TableImage air;  ///< air_azimuths x (air_ground_rows + air_sky_rows) x air_slices
    SkyUniforms uniforms;
};

/// @param eye ecef, metres, any finite position; below the ground sphere it counts as 1 m above it, and it should be
///        at most about 10^8 m from the centre (beyond, the shader's floats blur the limb)
/// @param sun ecef, unit, towards the sun
/// @param threads 1 or more; the result has the same bits for every number
/// Sets every uniform but sky_picture; exposure is exposure_for(), and the look (wind, night lights) has defaults.
ViewTable make_view_table(const AtmosphereTables& tables, const glm::dvec3& eye, const glm::dvec3& sun,
                          unsigned threads = 2);

/// The exposure that a photographer would set: 1 from 8,000 km up, half as much again in daylight near the ground, and
/// rising as the light on the ground below an eye in the air falls. Depends on nothing but its arguments.
float exposure_for(const AtmosphereTables& tables, const glm::dvec3& eye, const glm::dvec3& sun);

/// Whether some pixel of a picture can show ground finer than the imagery: if not, the shaders may be built with
/// FROM_AFAR defined and give the same picture.
/// @param height least distance from the eye to the ground, m   @param pixel_angle of the picture's middle, rad
inline bool needs_close_up(const SkyUniforms& uniforms, double height, double pixel_angle) {
    return height * pixel_angle < 0.4 * double(uniforms.sky_detail.w);
}

/// ecef to the space of the tables: z stretched by a/b.
glm::dvec3 sphere_from_ecef(const Atmosphere& air, const glm::dvec3& v);

/// RGBA8 noise that repeats, side^3 texels, x fastest: rgb the gradient (0.5 + 0.5 g), a the value; several octaves.
/// About 50 ms for 64: made once and kept.
/// @param side a power of two, 16..128
std::vector<std::uint8_t> make_noise_volume(int side = 64);

/// The same with its mip chain: levels from the finest down to 1 texel, each the mean of eight of the one before.
std::vector<std::vector<std::uint8_t>> make_noise_levels(int side = 64);

}  // namespace render
