// The planet-fixed grid of planet/mesh/grid.h: 42 bits a coordinate, from the eye with one rounding.
// MORPH: vertices come and go by moving from and to the middle of the side that they split (planet/mesh/morph.h). How far
// one is follows from its own diamond and the eye alone, so it is the same in all segments, and nothing cracks.

layout(location = 0) in ivec3 grid_word;  ///< 1/256 m
layout(location = 1) in uint grid_low;    ///< ten more bits each: 2^-18 m

uniform ivec3 eye_hi;  ///< of 8 m
uniform ivec3 eye_lo;  ///< of 2^-18 m, 0 .. 2^21 - 1

#ifdef MORPH
layout(location = 5) in vec3 to_side_middle;  ///< m
layout(location = 6) in vec3 diamond;         ///< deviation, radius, m: the vertex comes at radius + K deviation; width, m
uniform float morph_reach;                    ///< K

/// arrival_fraction(): 0 where the vertex comes, 1 where the eye is nearer by the width.
float arrival_fraction(float eye_distance) {
    float inside = diamond.y + morph_reach * diamond.x - 0.5 - eye_distance;
    float t = clamp(inside / max(diamond.z, 1.0e-6), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
#endif

/// The vertex relative to the eye, metres, ecef axes. Both differences convert exactly: hi is below 2^24 steps within
/// 134,000 km, lo below 2^21; their sum is the only rounding. Words are never subtracted: across the planet they wrap.
vec3 view_from_grid() {
    ivec3 low = ivec3(grid_low & 1023u, grid_low >> 10 & 1023u, grid_low >> 20 & 1023u);
    ivec3 hi = (grid_word >> 11) - eye_hi;
    ivec3 lo = ((grid_word & 2047) << 10 | low) - eye_lo;
    vec3 view = vec3(hi) * 8.0 + vec3(lo) * (1.0 / 262144.0);
#ifdef MORPH
    view += (1.0 - arrival_fraction(length(view))) * to_side_middle;
#endif
    return view;
}
