#version 450 core
// Triangles of a mesh's picture; three vertices each, so that their number tells the corner.
#include "mesh_part.glsl"

layout(location = 0) in vec3 place;
layout(location = 1) in vec4 paint;  ///< alpha: how strongly sides are drawn

out vec3 barycentric;
out vec4 tint;

void main() {
    gl_Position = clip_from_picture(place);
    int corner = gl_VertexID % 3;
    barycentric = vec3(corner == 0, corner == 1, corner == 2);
    tint = paint;
}
