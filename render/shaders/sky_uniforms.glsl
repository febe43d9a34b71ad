// The members of the uniform block SkyBlock, std140, binding 1. Also the members of the C++ struct SkyUniforms: only
// vec4, so that both layouts are the same. "Sphere space" is ecef with z stretched by a/b: there the ellipsoid is a
// sphere of radius a, and horizons, tangents and shadows are those of a sphere. All lengths are metres.
vec4 sky_up;            // xyz: unit vector from the planet's centre to the eye, sphere space; w: the eye's radius r
vec4 sky_side;          // xyz: unit, across sky_up towards the sun's azimuth, sphere space; w: a/b
vec4 sky_disc;          // x: ground^2 - r^2, y: top^2 - r^2, z: ground radius, w: top radius
vec4 sky_map;           // x: chord to the horizon, y: 1 outside the air, z, w: depth powers below and above the horizon
vec4 sky_ratio_below;   // rgb: optical depth in each channel over that in green, rays to the ground; w: 1 / J scale
vec4 sky_ratio_above;   // rgb: the same for rays that miss the ground
vec4 sky_sun;           // xyz: unit vector to the sun, ecef; w: cosine of its angular radius
vec4 sky_sunlight;      // rgb: irradiance of the sun outside the air; w: wind speed over the sea, m/s
vec4 sky_detail;        // xyz: the eye's ecef position modulo 2^17 m; w: side of a texel of the imagery, m
vec4 sky_exposure;      // x: exposure, y: radiance of a night-light value of 1, z: ambient radiance at night, w: seconds
vec4 sky_picture;       // xy: pixel offset of this part in the whole picture, z: star scale, w: pixel angle, rad
vec4 sky_near;          // xyz: the eye's ecef position modulo 2^7 m, to 8 micrometres; sky_detail's is good to 8 mm
