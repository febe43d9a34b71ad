// The planet-fixed grid of planet/mesh/grid.h: 42 bits a coordinate, from the eye with one rounding.

layout(location = 0) in ivec3 grid_word;  ///< 1/256 m
layout(location = 1) in uint grid_low;    ///< ten more bits each: 2^-18 m

uniform ivec3 eye_hi;  ///< of 8 m
uniform ivec3 eye_lo;  ///< of 2^-18 m, 0 .. 2^21 - 1

/// The vertex relative to the eye, metres, ecef axes. Both differences convert exactly: hi is below 2^24 steps within
/// 134,000 km, lo below 2^21; their sum is the only rounding. Words are never subtracted: across the planet they wrap.
vec3 view_from_grid() {
    ivec3 low = ivec3(grid_low & 1023u, grid_low >> 10 & 1023u, grid_low >> 20 & 1023u);
    ivec3 hi = (grid_word >> 11) - eye_hi;
    ivec3 lo = ((grid_word & 2047) << 10 | low) - eye_lo;
    return vec3(hi) * 8.0 + vec3(lo) * (1.0 / 262144.0);
}
