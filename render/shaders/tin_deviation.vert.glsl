#version 450 core
// Triangles between samples, each sample at the middle of its pixel.

layout(location = 0) in ivec2 place;  ///< (column, row)
layout(location = 1) in ivec2 corner_a;
layout(location = 2) in ivec2 corner_b;
layout(location = 3) in ivec2 corner_c;
layout(location = 4) in vec3 heights;  ///< of the corners, 0..1 over the raster's range
layout(location = 5) in float number;

uniform ivec2 size;   ///< pixels of the picture
uniform int margin;   ///< pixels around the raster

flat out ivec2 a, b, c;
flat out vec3 corner_heights;
flat out float triangle;

void main() {
    vec2 pixel = vec2(place + margin) + 0.5;
    gl_Position = vec4(2.0 * pixel / vec2(size) - 1.0, 0.0, 1.0);
    a = corner_a;
    b = corner_b;
    c = corner_c;
    corner_heights = heights;
    triangle = number;
}
