// Air between the eye and anything: sky radiance, aerial perspective, light that reaches the ground.
// This text is GLSL 4.5 and, inside render/sky/shading_reference.h, C++: literals carry an f, vectors are cut with
// constructors and not with swizzles, and functions return structs. The tables and their mappings are described in
// render/sky/atmosphere.h; the maps here are the inverses of those in view_table.cpp and must change together.

#ifndef __cplusplus
layout(std140, binding = 1) uniform SkyBlock {
#include "sky_uniforms.glsl"
};
layout(binding = 0) uniform sampler3D air_table;
layout(binding = 1) uniform sampler2D sun_light_table;
layout(binding = 2) uniform sampler2D sky_light_table;
#endif

/// What the air does between the eye and a point: radiance = background * transmittance + in_scatter.
struct Air {
    vec3 transmittance;
    vec3 in_scatter;
};

/// A direction as seen by the air table: azimuth and elevation coordinates in [0, 1], the piece of the ray inside the
/// air in metres of sphere space, and the power of the depth axis. leave <= enter where the ray misses the air.
struct AirRay {
    float azimuth;
    float elevation;
    float enter;
    float leave;
    float power;
    vec3 ratio;  ///< optical depth in each channel over that in green
};

const float air_azimuths = 64.0f;
const float air_ground_rows = 96.0f;
const float air_sky_rows = 64.0f;
const float air_slices = 16.0f;

/// Coordinate of the middle of the first texel at x = 0 and of the last one at x = 1.
float inset(float x, float texels) {
    return (x * (texels - 1.0f) + 0.5f) / texels;
}

/// @param direction unit, sphere space. Never NaN: at the zenith and nadir the azimuth is arbitrary and does not matter.
AirRay air_ray(vec3 direction) {
    AirRay ray;
    float mu = dot(direction, vec3(sky_up));
    float rmu = sky_up.w * mu;
    // Squared half-chords in the ground sphere and in the top sphere. The radii enter as differences of squares that
    // were formed in double: from 1 m up and from 50,000 km the horizon is sharp to a fraction of a scale height.
    float ground_disc = rmu * rmu + sky_disc.x;
    float top_disc = rmu * rmu + sky_disc.y;
    float top_half = sqrt(max(top_disc, 0.0f));
    bool outside = sky_map.y > 0.5f;
    bool hits_ground = ground_disc > 0.0f && mu < 0.0f;

    vec3 level = direction - mu * vec3(sky_up);
    float cos_azimuth = dot(level, vec3(sky_side)) / max(sqrt(dot(level, level)), 1.0e-6f);
    ray.azimuth = sqrt(clamp(0.5f - 0.5f * cos_azimuth, 0.0f, 1.0f));

    ray.enter = outside ? max(-sky_disc.y / max(top_half - rmu, 1.0f), 0.0f) : 0.0f;
    ray.leave = mu > 0.0f ? sky_disc.y / max(rmu + top_half, 1.0f) : top_half - rmu;
    if (outside && (mu > 0.0f || top_disc <= 0.0f)) ray.leave = ray.enter - 1.0f;
    ray.power = sky_map.w;
    ray.ratio = vec3(sky_ratio_above);
    float x;
    float rows = air_ground_rows + air_sky_rows;
    if (hits_ground) {
        float half_chord = sqrt(ground_disc);
        ray.leave = -sky_disc.x / max(half_chord - rmu, 1.0f);
        ray.power = sky_map.z;
        ray.ratio = vec3(sky_ratio_below);
        float incidence = half_chord / sky_disc.z;  // cosine at the ground
        x = sqrt(clamp(1.0f - sqrt(max(1.0f - incidence, 0.0f)), 0.0f, 1.0f));
        ray.elevation = inset(1.0f - x, air_ground_rows) * air_ground_rows / rows;
    } else {
        float perigee = sqrt(max(sky_disc.z * sky_disc.z - ground_disc, 0.0f));
        float above = -ground_disc / (perigee + sky_disc.z) / (sky_disc.w - sky_disc.z);
        float chord = sqrt(max(2.0f - 2.0f * mu, 0.0f));
        x = sqrt(clamp(outside ? above : 1.0f - chord / sky_map.x, 0.0f, 1.0f));
        ray.elevation = (inset(x, air_sky_rows) * air_sky_rows + air_ground_rows) / rows;
    }
    return ray;
}

/// The air along the first `distance` metres (sphere space) of a ray. @param share of its depth that counts, 0..1
Air air_along(AirRay ray, float distance, float share) {
    Air air;
    float length_in_air = clamp(distance, ray.enter, max(ray.leave, ray.enter)) - ray.enter;
    float s = length_in_air / max(ray.leave - ray.enter, 1.0f);
    float u = pow(max(s, 1.0e-12f), ray.power);
    vec4 texel = textureLod(air_table, vec3(inset(ray.azimuth, air_azimuths), ray.elevation, inset(u, air_slices)), 0.0f);
    // rgb: mean source function (Chandrasekhar's J) scaled; a: log of the mean extinction in green, per 1000 km.
    float depth = exp(texel.w) * length_in_air * 1.0e-6f * share;
    air.transmittance = exp(-depth * ray.ratio);
    // The night's own glow keeps the limb and the sky from pure black.
    vec3 source = vec3(texel) * sky_ratio_below.w + vec3(0.5f, 0.8f, 1.1f) * sky_exposure.z;
    air.in_scatter = (vec3(1.0f) - air.transmittance) * source;
    return air;
}

/// ecef -> sphere space, for vectors and positions.
vec3 sphere_from_ecef(vec3 v) {
    return vec3(v.x, v.y, v.z * sky_side.w);
}

/// The air between the eye and a point. @param view ecef vector from the eye to the point, metres.
Air air_to(vec3 view) {
    vec3 v = sphere_from_ecef(view);
    float distance = max(sqrt(dot(v, v)), 1.0e-3f);
    return air_along(air_ray(v / distance), distance, 1.0f);
}

/// The whole air behind a direction, to space or to the ground sphere. @param direction ecef, any length > 0.
Air air_beyond(vec3 direction) {
    vec3 v = sphere_from_ecef(direction);
    AirRay ray = air_ray(v / sqrt(dot(v, v)));
    return air_along(ray, max(ray.leave, 0.0f), 1.0f);
}

/// How much of the air before the ground is drawn. A photographer cuts haze with a filter and in print; all of it leaves
/// mountains 60 km away in milk. Where the air is deep either way, at the horizon, ground still fades into the sky.
const float haze_share = 0.35f;

/// Radiance of a surface after the air before it. @param view ecef vector from the eye, metres.
vec3 aerial(vec3 radiance, vec3 view) {
    vec3 v = sphere_from_ecef(view);
    float distance = max(sqrt(dot(v, v)), 1.0e-3f);
    Air air = air_along(air_ray(v / distance), distance, haze_share);
    return radiance * air.transmittance + air.in_scatter;
}

/// Irradiance at a height: from the sun on a plane that faces it (reddened, 0 in the planet's shadow), and from the
/// sky on a level plane.
struct Light {
    vec3 sun;
    vec3 sky;
};

/// @param h ellipsoidal height, m (clamped to -500..12,000)   @param sun_cosine cosine between the geodetic normal and the sun
Light light_at(float h, float sun_cosine) {
    Light light;
    const float top = 12500.0f;
    float up = clamp(h + 500.0f, 0.0f, top);
    // Sine of the dip of the ground sphere's horizon; the axis is the square root of the sun's height above it.
    float dip = sqrt(up * (2.0f * sky_disc.z + up)) / (sky_disc.z + up);
    float m = sun_cosine + dip;
    float x = m > 0.0f ? 0.25f + 0.75f * sqrt(min(m / (1.0f + dip), 1.0f)) : 0.25f - 0.25f * sqrt(min(-m / 0.4f, 1.0f));
    vec2 at = vec2(inset(x, 128.0f), inset(up / top, 16.0f));
    light.sun = vec3(textureLod(sun_light_table, at, 0.0f)) * vec3(sky_sunlight);
    light.sky = vec3(textureLod(sky_light_table, at, 0.0f)) * vec3(sky_sunlight);
    return light;
}
