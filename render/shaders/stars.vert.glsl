#version 450 core
// Stars as points, added to the finished sky: draw after sky.frag, blend ONE ONE, depth test GEQUAL, no depth writes,
// GL_PROGRAM_POINT_SIZE enabled. Attributes as render::Star. The sky behind is known here, so what is added is the
// difference that the star makes after the tone curve: none by day, the right colour at dusk.
#include "atmosphere.glsl"
#include "sky.glsl"
#include "tonemap.glsl"

layout(location = 0) uniform mat4 clip_from_ecef_direction;  // of directions (w = 0); the depth is set here
layout(location = 1) uniform mat3 ecef_from_inertial;        // the Earth's rotation at the time of the picture
layout(location = 0) in vec3 star_direction;
layout(location = 1) in vec3 star_light;

flat out vec3 behind;
flat out vec3 light;
flat out float spread;

void main() {
    vec3 d = ecef_from_inertial * star_direction;
    vec4 clip = clip_from_ecef_direction * vec4(d, 0.0);
    gl_Position = vec4(clip.xy, 0.0, clip.w);
    Air air = air_beyond(d);
    behind = air.in_scatter;
    // Stars are drawn brighter than they are (stars.h), so by day the sky must put them out as it does to the eye.
    float sky = dot(behind, vec3(0.2126, 0.7152, 0.0722)) * sky_exposure.x;
    light = star_light * air.transmittance * (sky_picture.z / (1.0 + 4.0e4 * sky * sky));
    float brightest = max(star_light.r, max(star_light.g, star_light.b));
    spread = 0.75 + 0.35 * clamp(log2(1.0 + brightest), 0.0, 2.0);
    gl_PointSize = ceil(spread * 6.0);
}
