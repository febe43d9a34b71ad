#version 450 core
// Sides, levels and the Sierpinski curve over the drawn terrain. Corner 0 is the pivot: the curve enters and leaves
// through the two sides that meet there, so it is the line where the pivot's weight is one half.

uniform ivec3 show;  ///< mesh, levels, curve

in vec3 barycentric;
flat in int level;
layout(location = 0) out vec4 color;

/// One colour a bisection level: the hue turns by a little over a quarter, so neighbours differ and none returns soon.
vec3 level_color(int l) {
    vec3 wheel = clamp(abs(fract(float(l) * 0.2847 + vec3(0.0, 0.6667, 0.3333)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
    return mix(vec3(0.92), wheel, 0.78);
}

/// Coverage of a line `width` pixels wide at distance |d| in the units of d. @param slope |gradient of d| per pixel
float line(float d, float slope, float width) {
    return 1.0 - smoothstep(0.5 * width - 0.5, 0.5 * width + 0.5, abs(d) / max(slope, 1.0e-9));
}

/// Lines fade where triangles are hardly larger than the lines.
float fade(float slope) {
    return 1.0 - smoothstep(0.12, 0.45, slope);
}

vec4 over(vec4 below, vec3 paint, float alpha) {
    return vec4(mix(below.rgb, paint, alpha / max(below.a + alpha - below.a * alpha, 1.0e-6)), below.a + alpha - below.a * alpha);
}

void main() {
    vec3 dx = dFdx(barycentric), dy = dFdy(barycentric);
    vec3 slope = sqrt(dx * dx + dy * dy);
    float widest = max(slope.x, max(slope.y, slope.z));
    vec4 c = vec4(0.0);
    if (show.y != 0) c = vec4(level_color(level), 0.55);
    if (show.x != 0) {
        float side = max(line(barycentric.x, slope.x, 1.2), max(line(barycentric.y, slope.y, 1.2), line(barycentric.z, slope.z, 1.2)));
        c = over(c, vec3(0.04, 0.05, 0.07), 0.75 * side * fade(widest));
    }
    if (show.z != 0) c = over(c, vec3(1.0, 0.93, 0.35), 0.95 * line(barycentric.x - 0.5, slope.x, 2.4) * fade(widest));
    color = c;
}
