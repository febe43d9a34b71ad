#version 450 core
#include "atmosphere.glsl"
#include "tonemap.glsl"

flat in vec3 behind;
flat in vec3 light;
flat in float spread;
layout(location = 0) out vec4 color;

void main() {
    vec2 offset = (gl_PointCoord - 0.5) * ceil(spread * 6.0);
    float psf = exp(-0.5 * dot(offset, offset) / (spread * spread));
    // A star's light is independent of the exposure that daylight asks for.
    vec3 star = light * psf / max(sky_exposure.x, 1.0);
    color = vec4(srgb_from_linear(filmic(behind + star)) - srgb_from_linear(filmic(behind)), 0.0);
}
