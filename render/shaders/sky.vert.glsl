#version 450 core
// One triangle over the whole picture at the far plane (reversed depth 0). Draw 3 vertices, no attributes, after the
// terrain, depth test GEQUAL, no depth writes.
#include "atmosphere.glsl"
#include "sky.glsl"

/// Takes (x, y, 0, 1) of clip space to a direction in ecef: inverse of the rotation part and the projection.
layout(location = 0) uniform mat4 ecef_direction_from_clip;

out vec3 direction;
flat out vec3 sun_through;

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
    vec4 d = ecef_direction_from_clip * vec4(corner, 0.0, 1.0);
    direction = d.xyz;
    sun_through = sun_through_air();
}
