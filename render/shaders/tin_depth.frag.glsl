#version 450 core
// The depth of a triangle at a sample. Depth that is interpolated from the vertices of what is drawn is worst in thin
// triangles, which would call for vertices that nobody needs. The weights of the corners here are whole numbers, and
// their mean has an error of a step or two.

uniform int margin;  ///< pixels around the raster

flat in ivec2 a, b, c;
flat in vec3 corner_heights;
flat in float triangle;
layout(location = 0) out float number;

void main() {
    ivec2 u = b - a, v = c - a, w = ivec2(gl_FragCoord.xy) - margin - a;
    int area = u.x * v.y - u.y * v.x, of_b = w.x * v.y - w.y * v.x, of_c = u.x * w.y - u.y * w.x;
    vec3 weights = vec3(area - of_b - of_c, of_b, of_c);
    gl_FragDepth = 0.5 + 0.5 * dot(weights, corner_heights) / float(area);
    number = triangle;
}
