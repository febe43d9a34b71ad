#version 450 core
#include "grid.glsl"

layout(location = 2) in uvec2 patch_place;  ///< 32768 = 1
layout(location = 3) in float height;       ///< m above the datum, not exaggerated
layout(location = 4) in int patch_layer;    ///< by segment; -1: no patch

uniform mat4 clip_from_ecef;  ///< of positions relative to the eye

out vec3 view;
out vec2 patch_uv;
out float orthometric;
flat out int layer;
invariant gl_Position;

void main() {
    view = view_from_grid();
    gl_Position = clip_from_ecef * vec4(view, 1.0);
    // Samples lie at the centres of the 65 texels of a row, the first and last on the patch's border.
    patch_uv = (vec2(patch_place) * (64.0 / 32768.0) + 0.5) / 65.0;
    orthometric = height;
    layer = patch_layer;
}
