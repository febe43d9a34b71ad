// From radiance to bytes. Also C++, see atmosphere.glsl.

/// Filmic curve from scene radiance (1: white paper in full sun) to display light 0..1: K. Narkowicz's fit of the ACES
/// reference transform, after a little cross-talk so that bright saturated light bleaches as film does.
vec3 filmic(vec3 radiance) {
    vec3 x = max(radiance, vec3(0.0f)) * sky_exposure.x * 1.1f;
    float grey = dot(x, vec3(0.2126f, 0.7152f, 0.0722f));
    x = mix(x, vec3(grey), 0.06f * grey / (1.0f + grey));
    return clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), vec3(0.0f), vec3(1.0f));
}

/// IEC 61966-2-1 to a quarter of an 8-bit step, by square roots alone (after I. Taylor): a third of the cost of powers on
/// a software renderer. @param light 0..1
vec3 srgb_from_linear(vec3 light) {
    vec3 low = light * 12.92f;
    vec3 s1 = sqrt(light);
    vec3 s2 = sqrt(s1);
    vec3 s3 = sqrt(s2);
    vec3 high = 0.662002687f * s1 + 0.684122060f * s2 - 0.323583601f * s3 - 0.0225411470f * light;
    return mix(high, low, vec3(lessThan(light, vec3(0.0031308f))));
}

/// One half-step of an 8-bit value, triangular, the same for the same pixel of the picture whatever part draws it.
/// @param pixel coordinates in the whole picture; interleaved gradient noise (J. Jimenez 2014), two phases of it
float dither(vec2 pixel) {
    float a = fract(52.9829189f * fract(dot(pixel, vec2(0.06711056f, 0.00583715f))));
    float b = fract(52.9829189f * fract(dot(pixel + vec2(47.0f, 17.0f), vec2(0.00583715f, 0.06711056f))));
    return (a + b - 1.0f) / 255.0f;
}

/// sRGB values 0..1 for an 8-bit target, dithered.
vec3 display_from_radiance(vec3 radiance, vec2 pixel) {
    return srgb_from_linear(filmic(radiance)) + vec3(dither(pixel));
}
