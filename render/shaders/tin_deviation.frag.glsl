#version 450 core
// How far a triangulation is from its raster, by the depths of both.

uniform sampler2D raster_depth;  ///< 0 where void
uniform sampler2D tin_depth;
uniform sampler2D tin_numbers;  ///< which triangle was drawn there
uniform float metres;           ///< of a depth of 1

layout(location = 0) out vec2 deviation;  ///< metres, and the triangle's number

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float raster = texelFetch(raster_depth, pixel, 0).r, tin = texelFetch(tin_depth, pixel, 0).r;
    deviation = vec2(raster == 0.0 ? 0.0 : metres * abs(raster - tin), texelFetch(tin_numbers, pixel, 0).r);
}
