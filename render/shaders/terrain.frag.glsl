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

void main() {
    vec3 place = eye + view;
    SurfaceInput s;
    s.view = view;
    s.normal = normalize(vec3(place.xy, place.z * shape.x));
    s.footprint = length(view) * pixel_angle;
#ifdef FROM_AFAR
    vec4 day = texture(day_cube, s.normal);
    s.imagery = day.rgb;
#else
    // Magnified texels are blobs: noise frays their borders by less than a texel and gives their insides grain.
    vec4 grain = patch_noise(view, 16384.0) * magnified(s.footprint);
    vec4 day = texture(day_cube, s.normal + grain.xyz * (0.45 * sky_detail.w / length(eye)));
    s.imagery = day.rgb * (1.0 + 0.22 * grain.w);
#endif
    s.water = day.a;
    s.night = texture(night_cube, s.normal).rgb;
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
