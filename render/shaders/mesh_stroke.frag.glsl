#version 450 core
// Lines that overlap, as the pieces of a curve do, must look like one: dark lines take the minimum with the picture and
// white ones the maximum, and neither minds a second time.

uniform bool lightens;

in vec2 pixel;
flat in vec4 ends;
flat in float half_width;
flat in vec4 tint;
layout(location = 0) out vec4 color;

void main() {
    vec2 along = ends.zw - ends.xy, p = pixel - ends.xy;
    float t = clamp(dot(p, along) / max(dot(along, along), 1.0e-12), 0.0, 1.0);
    float cover = clamp(half_width + 0.5 - length(p - t * along), 0.0, 1.0) * min(2.0 * half_width, 1.0) * tint.a;
    color = vec4(lightens ? tint.rgb * cover : mix(vec3(1.0), tint.rgb, cover), 1.0);
}
