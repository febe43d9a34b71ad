#version 450 core
// PATCHED: some segment has a patch. FROM_AFAR: see surface.glsl. Software renderers run every branch, so what a picture
// does not need is compiled out.
#include "atmosphere.glsl"
#include "surface.glsl"
#include "tonemap.glsl"

layout(binding = 4) uniform samplerCube day_cube;      ///< rgb colour, a the part that is water
layout(binding = 5) uniform samplerCube night_cube;    ///< lights
layout(binding = 6) uniform samplerCube relief_cube;   ///< twice the terrain normal's offset from the geodetic one
layout(binding = 7) uniform sampler2DArray patches;    ///< the same offset over patch_range, a: how much to believe it

uniform vec3 eye;              ///< ecef, m, rounded
uniform vec2 shape;            ///< (a/b)^2, the polar stretch of normals; exaggeration
uniform float pixel_angle;     ///< rad
uniform float patch_range;

in vec3 view;
in vec2 patch_uv;
in float orthometric;
flat in int layer;
layout(location = 0) out vec4 color;

#ifdef RELIEF
/// Linear colour of a height, m: the sea, then green lowlands over ochre to white, as in atlases. Shores are the imagery's,
/// for from afar triangles are larger than bays. @param water 0..1
vec3 height_color(float height, float water) {
    const vec3 sea = vec3(0.055, 0.125, 0.205);
    const vec3 tints[6] = vec3[](vec3(0.070, 0.150, 0.062), vec3(0.175, 0.210, 0.070), vec3(0.330, 0.230, 0.085),
                                 vec3(0.230, 0.110, 0.048), vec3(0.260, 0.190, 0.160), vec3(0.720, 0.730, 0.760));
    const float tops[6] = float[](0.0, 350.0, 1100.0, 2400.0, 3800.0, 5500.0);
    vec3 tint = tints[0];
    for (int i = 1; i < 6; ++i) tint = mix(tint, tints[i], clamp((height - tops[i - 1]) / (tops[i] - tops[i - 1]), 0.0, 1.0));
    return mix(tint, sea, smoothstep(0.35, 0.65, water));
}
#endif

void main() {
    vec3 place = eye + view;
    SurfaceInput s;
    s.view = view;
    s.normal = normalize(vec3(place.xy, place.z * shape.x));
    s.footprint = length(view) * pixel_angle;
#ifdef RELIEF
    vec4 day = vec4(height_color(orthometric, texture(day_cube, s.normal).a), 0.0);
    s.imagery = day.rgb;
#elif defined(FROM_AFAR)
    vec4 day = texture(day_cube, s.normal);
    s.imagery = day.rgb;
#else
    // Magnified texels are blobs: noise frays their borders by less than a texel and gives their insides grain.
    vec4 grain = patch_noise(view, 16384.0) * magnified(s.footprint);
    vec4 day = texture(day_cube, s.normal + grain.xyz * (0.45 * sky_detail.w / length(eye)));
    s.imagery = day.rgb * (1.0 + 0.22 * grain.w);
#endif
    s.water = day.a;
#ifdef RELIEF
    s.night = vec3(0.0);
#else
    s.night = texture(night_cube, s.normal).rgb;
#endif
    vec3 offset = texture(relief_cube, s.normal).xyz * 0.5;
#ifdef PATCHED
    vec2 dx = dFdx(patch_uv), dy = dFdy(patch_uv);
    vec4 fine = textureGrad(patches, vec3(patch_uv, float(max(layer, 0))), dx, dy);
    offset = mix(offset, fine.xyz * patch_range, layer < 0 ? 0.0 : fine.w);
#endif
    s.terrain_normal = normalize(s.normal + offset * shape.y);
    s.height = orthometric;
    vec3 radiance = aerial(surface_radiance(s), view);
    color = vec4(display_from_radiance(radiance, gl_FragCoord.xy + sky_picture.xy), 1.0);
}
