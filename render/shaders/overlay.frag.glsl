#version 450 core
// The mesh over the drawn terrain, and the graticule. Corner 0 is the pivot: the curve enters and leaves
// through the two sides that meet there, so it is the line where the pivot's weight is one half.

uniform ivec3 show;       ///< sides; what colours mean: 0 none, 1 levels, 2 segments, 3 deviations; curve
uniform vec3 eye;         ///< ecef, m
uniform float graticule;  ///< rad between its lines; 0: none
uniform float pixel_scale;  ///< of widths: below 1 where the picture is shown larger, above where its pixels are small

in vec3 barycentric;
in vec3 view;
flat in uint of_triangle;
layout(location = 0) out vec4 color;

/// One colour a bisection level: the hue turns by a little over a quarter, so neighbours differ and none returns soon.
vec3 level_color(int l) {
    vec3 wheel = clamp(abs(fract(float(l) * 0.2847 + vec3(0.0, 0.6667, 0.3333)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
    return mix(vec3(0.92), wheel, 0.78);
}

/// From dark blue over green to yellow.
vec3 deviation_color(float t) {
    vec3 cold = mix(vec3(0.20, 0.15, 0.45), vec3(0.10, 0.55, 0.55), smoothstep(0.0, 0.5, t));
    return mix(cold, vec3(0.99, 0.88, 0.25), smoothstep(0.45, 1.0, t));
}

vec3 fill_color() {
    if (show.y == 1) return level_color(int(of_triangle & 63u));
    if (show.y == 2) return level_color(int(of_triangle >> 6 & 255u));
    return deviation_color(float(of_triangle >> 14 & 255u) / 255.0);
}

/// Coverage of a line `width` pixels wide as shown at distance |d| in the units of d. One thinner than a pixel as drawn is
/// as much fainter. @param slope |gradient of d| per pixel
float line(float d, float slope, float width) {
    width *= pixel_scale;
    return min(width, 1.0) * (1.0 - smoothstep(0.5 * width - 0.5, 0.5 * width + 0.5, abs(d) / max(slope, 1.0e-9)));
}

/// Lines fade where triangles are hardly larger than the lines.
float fade(float slope) {
    return 1.0 - smoothstep(0.12, 0.45, slope * pixel_scale);
}

vec4 over(vec4 below, vec3 paint, float alpha) {
    return vec4(mix(below.rgb, paint, alpha / max(below.a + alpha - below.a * alpha, 1.0e-6)), below.a + alpha - below.a * alpha);
}

/// Coverage of parallels and meridians. The eye's place is rounded to half a metre: near the ground they fade.
float graticule_coverage() {
    const float polar_stretch = 1.0067394968;  // (a/b)^2
    vec3 place = eye + view;
    vec3 n = normalize(vec3(place.xy, place.z * polar_stretch));
    vec3 dx = dFdx(n), dy = dFdy(n);
    float across = max(length(n.xy), 1.0e-6);
    float latitude = atan(n.z, across), longitude = atan(n.y, n.x);
    // Not of the angles themselves, which jump at +-180.
    vec2 latitude_slope = vec2(dx.z, dy.z) / across;
    vec2 longitude_slope = vec2(n.x * dx.y - n.y * dx.x, n.x * dy.y - n.y * dy.x) / (across * across);
    float near_parallel = (fract(latitude / graticule + 0.5) - 0.5) * graticule;
    float near_meridian = (fract(longitude / graticule + 0.5) - 0.5) * graticule;
    float parallels = line(near_parallel, length(latitude_slope), 1.2) * fade(3.0 * length(latitude_slope) / graticule);
    float meridians = line(near_meridian, length(longitude_slope), 1.2) * fade(3.0 * length(longitude_slope) / graticule);
    return max(parallels, meridians) * smoothstep(4.0e-7, 1.2e-6, max(length(dx), length(dy)));
}

void main() {
    vec3 dx = dFdx(barycentric), dy = dFdy(barycentric);
    vec3 slope = sqrt(dx * dx + dy * dy);
    float widest = max(slope.x, max(slope.y, slope.z));
    vec4 c = vec4(0.0);
    if (show.y != 0) c = vec4(fill_color(), 0.55);
    if (show.x != 0) {
        float side = max(line(barycentric.x, slope.x, 1.2), max(line(barycentric.y, slope.y, 1.2), line(barycentric.z, slope.z, 1.2)));
        c = over(c, vec3(0.04, 0.05, 0.07), 0.75 * side * fade(widest));
    }
    if (show.z != 0) c = over(c, vec3(1.0, 0.93, 0.35), 0.95 * line(barycentric.x - 0.5, slope.x, 2.4) * fade(widest));
    if (graticule > 0.0) c = over(c, vec3(1.0), 0.55 * graticule_coverage());
    color = c;
}
