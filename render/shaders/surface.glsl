// Radiance of the planet's surface: land, sea, snow, night. Also C++, see atmosphere.glsl, which comes first.
//
// Define FROM_AFAR where every pixel is wider than 0.4 texels of the imagery (sky_detail.w): the picture is the same,
// and software renderers, which run every branch and the first turn of every loop whether or not a pixel
// takes it, save two fifths of the time.

#ifndef __cplusplus
layout(binding = 3) uniform sampler3D noise_table;
#endif

struct SurfaceInput {
    vec3 view;            ///< ecef vector from the eye to the point, m
    vec3 normal;          ///< geodetic normal, unit
    vec3 terrain_normal;  ///< normal of the ground, unit
    vec3 imagery;         ///< linear colour 0..1 of the day imagery
    vec3 night;           ///< linear colour 0..1 of the night lights
    float water;          ///< 0..1: part of the imagery's texel that is water
    float height;         ///< orthometric, m
    float footprint;      ///< side of the pixel there, m, as if it were seen from straight above
};

float luminance(vec3 c) {
    return dot(c, vec3(0.2126f, 0.7152f, 0.0722f));
}

/// Light of city lamps from a night-light value 0..1 (the square root of the light): sodium in the outskirts, and so
/// bright in the middle of cities that it bleaches.
vec3 lamps(float value) {
    float light = value * value;
    return mix(vec3(1.0f, 0.60f, 0.27f), vec3(1.0f, 0.80f, 0.54f), light) * (light * (0.7f + 2.3f * light));
}

/// How far the imagery's own texels are magnified: 0 where they are as fine as pixels, 1 where one covers thousands.
float close_up(float footprint) {
    return 1.0f - smoothstep(log2(sky_detail.w * 0.005f), log2(sky_detail.w * 0.15f), log2(max(footprint, 1.0e-3f)));
}

/// 0 from afar, where FROM_AFAR is, to 1 where a texel covers a hundred pixels.
float magnified(float footprint) {
    return 1.0f - smoothstep(sky_detail.w * 0.08f, sky_detail.w * 0.4f, footprint);
}

/// Noise at the planet-fixed point beside the eye, with the finest features at about two pixels whatever the distance:
/// two octave bands, cross-faded by the logarithm of the footprint. Mips come from the footprint too: where bands begin,
/// the differences between pixels mean nothing, and showed as dashes. rgb: gradient -1..1, a: value -1..1.
/// @param along the longer side of the pixel on the ground, m
vec4 detail_noise(vec3 view, float footprint, float along) {
    float level = log2(clamp(footprint, 0.002f, 1024.0f)) + 1.0f;
    float scale = exp2(-floor(level)) / 64.0f;
    // What repeats within 128 m takes the finer position, or millimetres of the eye would be centimetres of the noise.
    vec3 p = ((level < 1.0f ? vec3(sky_near) : vec3(sky_detail)) + view) * scale;
    // A texel is 2^floor(level) m, one to two footprints.
    float lod = max(log2(max(along, 0.002f)) - floor(level), 0.0f);
    vec4 finer = textureLod(noise_table, p, lod), coarser = textureLod(noise_table, p * 0.5f, max(lod - 1.0f, 0.0f));
    return mix(finer, coarser, fract(level)) * 2.0f - vec4(1.0f);
}

/// Noise with features of `size` metres and three octaves below, as far as the footprint allows. @param size a power of two up
/// to 2^15: its period, 4 sizes, then divides that of sky_detail, and the pattern stays where it is as the eye moves.
/// rgb: gradient -1..1, a: value -1..1
vec4 patch_noise(vec3 view, float size) {
    vec3 eye_place = size < 64.0f ? vec3(sky_near) : vec3(sky_detail);
    return texture(noise_table, (eye_place + view) / (4.0f * size)) * 2.0f - vec4(1.0f);
}

/// Heights in metres at which forest ends and snow stays, by |sine of the latitude|: straight lines through the
/// equator and subtropics (4,100 m), Colorado (3,600), the Alps (2,300) and 65 degrees (300).
float treeline_at(float sin_latitude) {
    return clamp(3600.0f - (sin_latitude - 0.609f) * 11200.0f, -400.0f, 4100.0f);
}

/// Sine of the slope towards the nearer pole: where snow stays longest. Fades to 0 at the equator.
float poleward(SurfaceInput s) {
    float rise = s.terrain_normal.z - s.normal.z * dot(s.terrain_normal, s.normal);
    return rise / max(sqrt(1.0f - s.normal.z * s.normal.z), 0.05f) * clamp(s.normal.z * 8.0f, -1.0f, 1.0f);
}

/// What one stands on where imagery has no more to say: colour from height, slope, latitude and the imagery's hue.
/// @param steep cosine of the slope   @param large, small noise -1..1
vec3 ground_cover(SurfaceInput s, float steep, float large, float small) {
    float lum = max(luminance(s.imagery), 0.004f);
    // Forest is dark in any imagery, and drought is yellow and bright.
    float dry = smoothstep(0.9f, 1.35f, s.imagery.r / max(s.imagery.g, 0.004f)) * smoothstep(0.025f, 0.085f, lum);
    float treeline = treeline_at(abs(s.normal.z)) + 180.0f * large;
    float h = s.height + 60.0f * small;

    // Meadow, or steppe with its shrubs, or the brown turf above the trees; all take some of the imagery's hue.
    vec3 hue = s.imagery / lum;
    // Shrubs as far as they can be told apart, then their mean.
    float tuft = mix(smoothstep(-0.2f, 0.5f, small + 0.4f * large), 0.3f, smoothstep(0.5f, 3.0f, s.footprint));
    vec3 meadow = mix(vec3(0.072f, 0.084f, 0.036f), hue * 0.075f, 0.3f);
    vec3 steppe = mix(vec3(0.235f, 0.205f, 0.140f), hue * 0.20f, 0.3f);
    steppe = mix(steppe, vec3(0.085f, 0.080f, 0.054f), 0.9f * tuft);
    vec3 turf = mix(vec3(0.125f, 0.116f, 0.066f), vec3(0.105f, 0.118f, 0.052f), smoothstep(-0.4f, 0.4f, large));
    vec3 open = mix(mix(meadow, steppe, dry), turf, smoothstep(treeline - 350.0f, treeline + 50.0f, h));
    open *= 1.0f + 0.15f * large + 0.35f * small;
    vec3 trees = mix(vec3(0.026f, 0.038f, 0.019f), hue * 0.040f, 0.3f) * (1.0f + 0.6f * small);
    vec3 scree = mix(vec3(0.190f, 0.172f, 0.152f), hue * 0.17f, 0.25f);
    vec3 rock = mix(vec3(0.118f, 0.106f, 0.096f), hue * 0.105f, 0.25f);
    vec3 snow = vec3(0.80f, 0.83f, 0.88f);

    float below = 1.0f - smoothstep(treeline - 170.0f, treeline + 60.0f, h);
    float wet = max(1.0f - dry, 0.85f * smoothstep(treeline - 1200.0f, treeline - 500.0f, h + 350.0f * large));
    float stand = smoothstep(-0.4f, 0.2f, large * 0.7f + small * 0.7f + 0.9f * wet - 0.4f);
    vec3 cover = mix(open, trees, below * wet * stand * smoothstep(0.55f, 0.75f, steep));
    float bare = smoothstep(treeline + 40.0f, treeline + 460.0f, h + 260.0f * small + 120.0f * large);
    bare = max(bare, 1.0f - smoothstep(0.76f, 0.87f, steep + 0.06f * small));
    float cliff = 1.0f - smoothstep(0.66f, 0.84f, steep + 0.1f * small);
    cover = mix(cover, mix(scree, rock, cliff) * (1.0f + 0.4f * small + 0.15f * large), bare);

    // Snow for good high up; its remnants lie lower, in patches, mostly on slopes that face away from the noon sun.
    float away = poleward(s);
    float snowline = treeline + mix(800.0f, 1100.0f, dry) - 250.0f * clamp(2.0f * away, -1.0f, 1.0f);
    float lies = smoothstep(0.66f, 0.80f, steep + 0.08f * small);
    float white = smoothstep(snowline - 100.0f, snowline + 300.0f, h + 320.0f * small);
    float remnant = smoothstep(0.30f, 0.42f, 0.5f * small + 0.5f * large + 0.8f * away);
    white = max(white, remnant * smoothstep(treeline + 60.0f, treeline + 420.0f, h));
    // Ice in the imagery (bright and not yellow) is believed anywhere it can lie.
    float ice = smoothstep(0.42f, 0.62f, lum) * smoothstep(0.80f, 0.92f, s.imagery.b / max(s.imagery.r, 0.01f));
    return mix(cover, snow * (1.0f + 0.06f * small), max(white, ice) * lies);
}

/// Reflectance of water towards the eye for a mirror facet: Schlick, index 1.34.
float fresnel_water(float cosine) {
    float c = 1.0f - clamp(cosine, 0.0f, 1.0f);
    float c2 = c * c;
    return 0.0211f + 0.9789f * c2 * c2 * c;
}

/// Density of wave facets whose normal has a cosine c with the vertical, for a mean square slope: a Gaussian.
float facets(float c, float slope2) {
    float c2 = c * c;
    return exp(-(1.0f - c2) / (c2 * slope2)) / (3.14159265f * slope2 * c2 * c2);
}

/// The sea: light from below its surface, the sun's glint off slopes spread as Cox and Munk (1954) measured against the
/// wind, and the sky in it. @param to_eye unit, ecef
vec3 sea_radiance(SurfaceInput s, Light light, vec3 to_eye, vec3 color) {
    vec3 sun = vec3(sky_sun);
    float cos_view = dot(s.normal, to_eye);
    float cos_sun = dot(s.normal, sun);
    vec3 between = sun + to_eye;
    vec3 facet = between / max(sqrt(dot(between, between)), 1.0e-4f);
    float c = max(dot(s.normal, facet), 0.05f);
    // Winds differ from place to place: a calm part gives the bright core, the rough one the wide skirt.
    float slope2 = 0.003f + 0.00512f * sky_sunlight.w;
    float spread = mix(facets(c, slope2), facets(c, 0.003f + 0.0009f * sky_sunlight.w), 0.4f);
    // Grazing views see waves that face them: the mean visible slope keeps both cosines off zero.
    float rough = sqrt(slope2) * 0.5f;
    float glint = fresnel_water(dot(facet, to_eye)) * spread / (4.0f * max(cos_view, rough) + 4.0f * rough);
    glint = min(glint, 4.0f) * smoothstep(-0.02f, 0.06f, cos_sun);

    float mirror = fresnel_water(sqrt(max(cos_view, 0.0f) * max(cos_view, 0.0f) + rough * rough * 4.0f));
    vec3 sky = light.sky * (0.3183099f * mix(1.0f, 1.7f, 1.0f - clamp(cos_view * 2.0f, 0.0f, 1.0f)));
    vec3 below = color * 0.3183099f * (light.sun * max(cos_sun, 0.0f) + light.sky) * (1.0f - mirror);
    return below + sky * mirror + light.sun * vec3(1.0f, 0.93f, 0.80f) * glint;
}

/// Radiance that leaves the surface towards the eye; the air before it is aerial()'s.
vec3 surface_radiance(SurfaceInput s) {
    vec3 to_eye = -s.view / max(sqrt(dot(s.view, s.view)), 1.0e-3f);
    vec3 sun = vec3(sky_sun);
    float sun_cosine = dot(s.normal, sun);
    Light light = light_at(s.height, sun_cosine);

    vec3 albedo = s.imagery;
    // Averaging normals over wide pixels flattens relief and no shadows are cast: slopes are drawn steeper from afar.
    float drawn_slope = 1.0f + 0.9f * smoothstep(10.0f, 300.0f, s.footprint);
    vec3 ground = normalize(s.normal + (s.terrain_normal - s.normal) * drawn_slope);
    float water = s.water;
    float near = 0.0f;
#ifndef FROM_AFAR
    near = close_up(s.footprint);
    {
        // On a slope seen at a grazing angle a pixel is long: what is finer than that would be dashes along crests.
        SurfaceInput slanted = s;
        slanted.footprint = s.footprint / max(dot(s.terrain_normal, to_eye), 0.08f);
        vec4 fine = detail_noise(s.view, sqrt(s.footprint * slanted.footprint), slanted.footprint);
        float middle = patch_noise(s.view, 256.0f).w;
        float large = patch_noise(s.view, 2048.0f).w + 0.5f * middle;
        // Single stones and bushes are what a pixel can show near by; from afar as strong a grain would be felt, not ground.
        float small = mix(0.75f, 0.35f, smoothstep(2.0f, 40.0f, slanted.footprint)) * fine.w + 0.4f * middle + 0.7f * patch_noise(s.view, 4.0f).w;
        // Bumps stand for what is finer than any elevation data: none from afar, few on the plains but for stones and tufts.
        vec3 bump = vec3(fine) - dot(vec3(fine), ground) * ground;
        float rough = (1.0f - smoothstep(15.0f, 150.0f, slanted.footprint)) * min(1.0f - 0.7f * smoothstep(0.3f, 3.0f, slanted.footprint) + 2.5f * (1.0f - dot(ground, s.normal)), 1.0f);
        vec3 cover = ground_cover(slanted, dot(ground, s.normal), large, small);
        ground = normalize(ground - bump * (0.35f * near * rough));
        albedo = mix(albedo, cover, near);
        float shore = smoothstep(0.35f, 0.65f, s.water + (s.height < 0.5f ? 0.3f : -0.15f));
        water = mix(water, shore, max(near, magnified(s.footprint)));
    }
#endif

    float facing = max(dot(ground, sun), 0.0f);
    // Sky light falls on a slope in proportion to the sky it sees; the ground around gives the rest.
    float open = 0.5f + 0.5f * dot(ground, s.normal);
    vec3 level = light.sun * max(sun_cosine, 0.0f) + light.sky;
    vec3 irradiance = light.sun * facing + light.sky * open + level * (0.2f * (1.0f - open));
    vec3 land = albedo * 0.3183099f * irradiance;
    // Imagery paints shoals in a blue that no sea has.
    vec3 deep = vec3(0.008f, 0.026f, 0.046f);
    vec3 sea = sea_radiance(s, light, to_eye, mix(s.imagery * vec3(0.9f, 0.85f, 0.6f), deep, 0.25f + 0.5f * near));
    vec3 day = mix(land, sea, water);

    float dark = 1.0f - smoothstep(-0.14f, 0.03f, sun_cosine);
    // Streets between houses are hidden from low angles.
    float seen = smoothstep(0.0f, 0.35f, dot(s.normal, to_eye));
    vec3 cities = lamps(sqrt(max(s.night.r, 0.0f))) * (sky_exposure.y * dark * seen);
    // Moonlight, ten times the air's own glow.
    vec3 ambient = mix(albedo, vec3(0.02f, 0.03f, 0.05f), water) * vec3(7.5f, 9.0f, 12.0f) * sky_exposure.z;
    return day + cities + ambient;
}
