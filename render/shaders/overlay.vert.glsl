#version 450 core
#include "grid.glsl"

layout(location = 2) in uint traits;  ///< of its triangle: corner 0-1, level 2-7, colour of the segment 8-15, deviation 16-23

uniform mat4 clip_from_ecef;

out vec3 barycentric;
out vec3 view;
flat out uint of_triangle;
invariant gl_Position;

void main() {
    view = view_from_grid();
    gl_Position = clip_from_ecef * vec4(view, 1.0);
    uint corner = traits & 3u;
    barycentric = vec3(corner == 0u, corner == 1u, corner == 2u);
    of_triangle = traits >> 2;
}
