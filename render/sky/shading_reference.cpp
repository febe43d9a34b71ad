#include "render/sky/shading_reference.h"

#include <algorithm>
#include <cmath>

namespace render::reference {
namespace {

/// The two texels along a clamped axis and the weight of the second.
struct Pair {
    int a, b;
    float w;
};
Pair clamped(float x, int n) {
    const float at = std::clamp(x * static_cast<float>(n) - 0.5f, 0.0f, static_cast<float>(n - 1));
    const int a = std::min(static_cast<int>(at), n - 1);
    return {a, std::min(a + 1, n - 1), at - static_cast<float>(a)};
}
Pair repeated(float x, int n) {
    const float at = x * static_cast<float>(n) - 0.5f, low = std::floor(at);
    const int a = static_cast<int>(((static_cast<long long>(low) % n) + n) % n);
    return {a, (a + 1) % n, at - low};
}

}  // namespace

vec4 textureLod(const ClampedSampler& s, const vec2& at, float) {
    const Pair x = clamped(at.x, s.image->width), y = clamped(at.y, s.image->height);
    return mix(mix(s.image->at(x.a, y.a), s.image->at(x.b, y.a), x.w),
               mix(s.image->at(x.a, y.b), s.image->at(x.b, y.b), x.w), y.w);
}

vec4 textureLod(const ClampedSampler& s, const vec3& at, float) {
    const Pair x = clamped(at.x, s.image->width), y = clamped(at.y, s.image->height), z = clamped(at.z, s.image->depth);
    const auto plane = [&](int k) {
        return mix(mix(s.image->at(x.a, y.a, k), s.image->at(x.b, y.a, k), x.w),
                   mix(s.image->at(x.a, y.b, k), s.image->at(x.b, y.b, k), x.w), y.w);
    };
    return mix(plane(z.a), plane(z.b), z.w);
}

vec4 texture(const RepeatedVolume& v, const vec3& at) {
    const Pair p[3] = {repeated(at.x, v.side), repeated(at.y, v.side), repeated(at.z, v.side)};
    vec4 sum(0);
    for (int k = 0; k < 8; ++k) {
        const int x = k & 1 ? p[0].b : p[0].a, y = k & 2 ? p[1].b : p[1].a, z = k & 4 ? p[2].b : p[2].a;
        const float w = (k & 1 ? p[0].w : 1 - p[0].w) * (k & 2 ? p[1].w : 1 - p[1].w) * (k & 4 ? p[2].w : 1 - p[2].w);
        const std::uint8_t* t =
            v.texels +
            4 * ((static_cast<std::size_t>(z) * static_cast<std::size_t>(v.side) + static_cast<std::size_t>(y)) *
                     static_cast<std::size_t>(v.side) +
                 static_cast<std::size_t>(x));
        sum += w * vec4(t[0], t[1], t[2], t[3]);
    }
    return sum / 255.0f;
}

vec4 textureLod(const RepeatedVolume& v, const vec3& at, float) {
    return texture(v, at);
}

}  // namespace render::reference
