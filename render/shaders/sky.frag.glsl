#version 450 core
#include "atmosphere.glsl"
#include "sky.glsl"
#include "tonemap.glsl"

in vec3 direction;
flat in vec3 sun_through;
layout(location = 0) out vec4 color;

void main() {
    vec3 radiance = sky_radiance(normalize(direction), sun_through);
    color = vec4(display_from_radiance(radiance, gl_FragCoord.xy + sky_picture.xy), 1.0);
}
