// What lies behind everything: air, the sun's disc and its glare. Also C++, see atmosphere.glsl, which comes first.

/// Sun light that reaches the eye, as a factor: 0 when the ground sphere hides the sun. Once per picture.
vec3 sun_through_air() {
    vec3 sphere = sphere_from_ecef(vec3(sky_sun));
    AirRay ray = air_ray(sphere / sqrt(dot(sphere, sphere)));
    float mu = dot(sphere, vec3(sky_up)) / sqrt(dot(sphere, sphere));
    float rmu = sky_up.w * mu;
    bool hidden = mu < 0.0f && rmu * rmu + sky_disc.x > 0.0f;
    return hidden ? vec3(0.0f) : air_along(ray, max(ray.leave, 0.0f), 1.0f).transmittance;
}

/// Radiance of the sky in a direction, stars left out. @param direction ecef, unit  @param through sun_through_air()
vec3 sky_radiance(vec3 direction, vec3 through) {
    Air air = air_beyond(direction);
    // Squared angle to the sun from the chord: exact where a cosine in float has no digits left.
    vec3 chord = direction - vec3(sky_sun);
    float angle2 = dot(chord, chord);
    float radius2 = 2.0f - 2.0f * sky_sun.w;
    float soft = sky_picture.w * sqrt(radius2) * 2.0f + 1.0e-9f;
    float inside = clamp(0.5f + (radius2 - angle2) / soft, 0.0f, 1.0f);
    // Limb darkening: Hestroffer and Magnan 1998, exponents at 680, 550 and 440 nm there.
    float cosine = sqrt(max(1.0f - angle2 / radius2, 0.0f));
    vec3 limb = pow(vec3(max(cosine, 0.02f)), vec3(0.397f, 0.503f, 0.652f));
    // The disc is 46,000 times white paper; a tenth of a thousandth of that already fills the film.
    vec3 disc = inside * limb * 60.0f * air.transmittance;
    float near_sun = radius2 / (angle2 + radius2);
    vec3 glare = through * (0.9f * near_sun * sqrt(near_sun) + 0.012f * exp(-angle2 * 90.0f));
    return air.in_scatter + disc + glare;
}
