#version 450 core
#include "grid.glsl"

layout(location = 2) in uint corner_and_level;  ///< corner 0..2 of its triangle in bits 0-1, bisection level above

uniform mat4 clip_from_ecef;

out vec3 barycentric;
flat out int level;
invariant gl_Position;

void main() {
    gl_Position = clip_from_ecef * vec4(view_from_grid(), 1.0);
    uint corner = corner_and_level & 3u;
    barycentric = vec3(corner == 0u, corner == 1u, corner == 2u);
    level = int(corner_and_level >> 2);
}
