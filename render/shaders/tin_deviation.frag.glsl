#version 450 core
// The depth of a triangle at a sample, and how far it is from that of the raster.
//
// Depth that is interpolated from the vertices of what is drawn is worst in thin triangles, which would call for vertices
// that nobody needs. The weights of the corners here are whole numbers, and their mean has an error of a step or two.

uniform sampler2D raster_depth;  ///< 0 where void
uniform int margin;              ///< pixels around the raster
uniform float metres;            ///< of a depth of 1

flat in ivec2 a, b, c;
flat in vec3 corner_heights;
flat in float triangle;
layout(location = 0) out vec2 deviation;  ///< metres, and the triangle's number

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    ivec2 u = b - a, v = c - a, w = pixel - margin - a;
    int area = u.x * v.y - u.y * v.x, of_b = w.x * v.y - w.y * v.x, of_c = u.x * w.y - u.y * w.x;
    vec3 weights = vec3(area - of_b - of_c, of_b, of_c);
    float depth = 0.5 + 0.5 * dot(weights, corner_heights) / float(area);
    float raster = texelFetch(raster_depth, pixel, 0).r;
    gl_FragDepth = depth;
    deviation = vec2(raster == 0.0 ? 0.0 : metres * abs(raster - depth), triangle);
}
