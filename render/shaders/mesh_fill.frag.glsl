#version 450 core
// Colour and sides of triangles. A side is where a barycentric coordinate is 0, and its derivatives give the distance to
// it in pixels: lines have their width however a triangle lies, and both triangles at a side draw one half each.

uniform float widest;  ///< line, pixels
uniform vec3 ink;

in vec3 barycentric;
in vec4 tint;
layout(location = 0) out vec4 color;

void main() {
    vec3 dx = dFdx(barycentric), dy = dFdy(barycentric);
    vec3 slope = max(sqrt(dx * dx + dy * dy), 1.0e-9);  // 1 / heights of the triangle
    vec3 away = abs(barycentric) / slope;
    float height = 1.0 / max(slope.x, max(slope.y, slope.z));
    float width = min(0.55 + 0.025 * height, widest);
    float side = clamp(0.5 * width + 0.5 - min(away.x, min(away.y, away.z)), 0.0, 1.0) * min(width, 1.0);
    // Lines fade where triangles are hardly larger.
    side *= smoothstep(2.0, 8.0, height) * 0.9 * tint.a;
    color = vec4(mix(tint.rgb, ink, side), 1.0);
}
