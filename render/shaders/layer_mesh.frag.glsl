#version 450 core
// Lit as the terrain is.
#include "atmosphere.glsl"
#include "surface.glsl"
#include "tonemap.glsl"

uniform vec3 eye;           ///< ecef, m, rounded
uniform vec2 shape;         ///< (a/b)^2, the polar stretch of normals; exaggeration
uniform float pixel_angle;  ///< rad
uniform bool own_colors, textured;
layout(binding = 8) uniform sampler2D picture;
uniform vec4 paint;         ///< linear colour, opacity

in vec3 view;
in vec3 ground;
in float orthometric;
in vec3 own_color;
in vec2 picture_place;
layout(location = 0) out vec4 color;

void main() {
    vec3 place = eye + view;
    SurfaceInput s;
    s.view = view;
    s.normal = normalize(vec3(place.xy, place.z * shape.x));
    s.terrain_normal = normalize(ground);
    s.imagery = own_colors ? own_color : paint.rgb;
    if (textured) s.imagery *= texture(picture, picture_place).rgb;
    s.night = vec3(0.0);
    s.water = 0.0;
    s.height = orthometric;
    s.footprint = length(view) * pixel_angle;
    vec3 radiance = aerial(surface_radiance(s), view);
    color = vec4(display_from_radiance(radiance, gl_FragCoord.xy + sky_picture.xy), paint.a);
}
