#pragma once
// The shaders' text as C++: the same mathematics on the CPU, pixel by pixel, for tests and previews. Not fast.
// Samplers are lookups with the filters of atmosphere.h; the functions of the shaders are members of Shading, and the
// uniforms its inherited members. They change nothing, so threads can share an object.

#include <glm/glm.hpp>

#include "render/sky/atmosphere.h"

namespace render::reference {

using namespace glm;

/// A table with clamped coordinates and linear filter on two or three axes.
struct ClampedSampler {
    const TableImage* image = nullptr;
};
/// RGBA8 volume that repeats, linear. Mip levels are not modelled: level 0 is read.
struct RepeatedVolume {
    const std::uint8_t* texels = nullptr;
    int side = 0;
};
using sampler2D = ClampedSampler;
using sampler3D = ClampedSampler;

vec4 textureLod(const ClampedSampler& sampler, const vec2& at, float lod);
vec4 textureLod(const ClampedSampler& sampler, const vec3& at, float lod);
vec4 texture(const RepeatedVolume& volume, const vec3& at);
/// Without mips: level 0 whatever the lod.
vec4 textureLod(const RepeatedVolume& volume, const vec3& at, float lod);

/// The shaders with their uniforms and textures.
struct Shading : SkyUniforms {
    sampler3D air_table;
    sampler2D sun_light_table, sky_light_table;
    RepeatedVolume noise_table;

    Shading(const SkyUniforms& uniforms, const AtmosphereTables& tables, const ViewTable& view)
        : SkyUniforms(uniforms),
          air_table{&view.air},
          sun_light_table{&tables.sun_light},
          sky_light_table{&tables.sky_light} {}

#include "render/shaders/atmosphere.glsl"
#include "render/shaders/sky.glsl"
#include "render/shaders/surface.glsl"
#include "render/shaders/tonemap.glsl"
};

}  // namespace render::reference
