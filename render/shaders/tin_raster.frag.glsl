#version 450 core
// A raster drawn to depth, a sample a pixel; nothing is drawn where it is void.

uniform sampler2D heights;  ///< 0..1 over the raster's range; negative where void
uniform int margin;         ///< pixels around the raster

void main() {
    float height = texelFetch(heights, ivec2(gl_FragCoord.xy) - margin, 0).r;
    if (height < 0.0) discard;
    gl_FragDepth = 0.5 + 0.5 * height;
}
