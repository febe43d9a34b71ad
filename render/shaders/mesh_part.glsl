// Picture coordinates: pixels from the top left, x right, y down; z pixels towards the viewer.

uniform vec4 part;         ///< left and top of the part, 2 / its width and height
uniform float depth_span;  ///< all z lie within half of it of 0

vec4 clip_from_picture(vec3 p) {
    vec2 ndc = (p.xy - part.xy) * part.zw - 1.0;
    return vec4(ndc.x, -ndc.y, p.z / depth_span + 0.5, 1.0);
}
