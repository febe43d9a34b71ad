#version 450 core
// The walls below and above the sides of polygons.

layout(location = 0) in vec4 place;  ///< relative to the eye, ecef, m; w 0: a direction, which is at infinity

uniform mat4 clip_from_ecef;

void main() {
    gl_Position = clip_from_ecef * place;
}
