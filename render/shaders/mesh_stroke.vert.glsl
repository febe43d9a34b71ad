#version 450 core
// Lines with round ends: four vertices each, the corners of a rectangle around it.
#include "mesh_part.glsl"

layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in float width;  ///< pixels
layout(location = 3) in vec4 paint;

uniform float lift;  ///< towards the viewer, pixels

out vec2 pixel;
flat out vec4 ends;
flat out float half_width;
flat out vec4 tint;

void main() {
    vec2 along = to.xy - from.xy;
    float size = length(along);
    along = size > 0.0 ? along / size : vec2(1.0, 0.0);
    float reach = 0.5 * width + 1.0;
    bool at_end = (gl_VertexID & 1) != 0;
    vec3 place = at_end ? to : from;
    place.xy += reach * ((at_end ? along : -along) + ((gl_VertexID & 2) != 0 ? 1.0 : -1.0) * vec2(-along.y, along.x));
    place.z += lift;
    gl_Position = clip_from_picture(place);
    pixel = place.xy;
    ends = vec4(from.xy, to.xy);
    half_width = 0.5 * width;
    tint = paint;
}
