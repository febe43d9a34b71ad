#version 450 core
// The alpha of a layer's lines: pieces overlap, so the largest counts. A line is seen where its middle is no farther than
// the ground in one of the nine pixels there: then none is lost in the ground it lies on, and none is seen through more
// than a pixel of a hill. A mesh that was drawn before hides it only where it cannot stand for the ground of the line.
#include "mesh_lift.glsl"

layout(binding = 0) uniform sampler2D ground_depth;  ///< of the terrain alone
layout(binding = 1) uniform sampler2D mesh_depth;    ///< with the meshes drawn before

uniform vec4 part;
uniform float half_width;
uniform float opacity;
uniform float pixel_slack;  ///< 1 - the angle of half its width, rad: what a place may seem farther than it is
uniform float lift;         ///< m, of meshes; 0: none was drawn before
uniform float near;         ///< m: depth 1

in vec2 pixel;
flat in vec3 start;
flat in vec3 end;
layout(location = 0) out vec4 color;

float farthest_around(sampler2D depth, ivec2 texel) {
    float farthest = 1.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            farthest = min(farthest, texelFetch(depth, clamp(texel + ivec2(x, y), ivec2(0), ivec2(part.zw) - 1), 0).r);
    return farthest;
}

bool seen(vec3 place) {
    ivec2 texel = ivec2(floor(vec2(place.x - part.x, part.w - (place.y - part.y))));
    if (place.z < farthest_around(ground_depth, texel) * pixel_slack) return false;
    if (lift == 0.0) return true;
    float mesh = near / max(farthest_around(mesh_depth, texel), 1.0e-20);
    return near / place.z <= mesh + mesh_lift(lift, mesh);
}

void main() {
    vec2 along = end.xy - start.xy, p = pixel - start.xy;
    float t = clamp(dot(p, along) / max(dot(along, along), 1.0e-12), 0.0, 1.0);
    float cover = clamp(half_width + 0.5 - length(p - t * along), 0.0, 1.0) * min(2.0 * half_width, 1.0);
    if (cover == 0.0 || !seen(mix(start, end, t))) discard;
    color = vec4(0.0, 0.0, 0.0, cover * opacity);
}
