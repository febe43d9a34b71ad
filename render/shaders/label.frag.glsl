#version 450 core
// Letters from distances to their outline.

layout(binding = 0) uniform sampler2D atlas;

uniform float pixels_of_texel;  ///< of the picture, in a difference of 1 between texels
uniform float rim;              ///< pixels around the letter that belong to it
uniform vec4 paint;

in vec2 uv;
layout(location = 0) out vec4 color;

void main() {
    float inside = (texture(atlas, uv).r - 128.0 / 255.0) * pixels_of_texel;
    float soft = rim > 0.0 ? 1.2 : 0.5;
    color = vec4(paint.rgb, paint.a * smoothstep(-rim - soft, -rim + soft, inside));
}
