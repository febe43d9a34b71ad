#version 450 core
#include "grid.glsl"
#include "mesh_lift.glsl"

layout(location = 2) in vec3 normal;   ///< ecef, unit
layout(location = 3) in float height;  ///< m above the geoid, not exaggerated

layout(location = 4) in vec4 own;      ///< linear colour
layout(location = 5) in vec2 uv;       ///< of the picture

uniform mat4 clip_from_ecef;
uniform float lift;  ///< m: drawn as if it were nearer by that much, where depths are compared

out vec3 view;
out vec3 ground;
out float orthometric;
out vec3 own_color;
out vec2 picture_place;
invariant gl_Position;

void main() {
    view = view_from_grid();
    gl_Position = clip_from_ecef * vec4(view, 1.0);
    float w = gl_Position.w;
    if (w > 0.0) gl_Position.z *= w / (w - mesh_lift(lift, w));
    ground = normal;
    orthometric = height;
    own_color = own.rgb;
    picture_place = uv;
}
