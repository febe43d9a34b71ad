#version 450 core
// A letter: four vertices. Places are pixels of the whole picture from its top left.

layout(location = 0) in vec4 box;     ///< left, top, right, bottom
layout(location = 1) in vec4 texels;  ///< the same in the atlas, 0..1

uniform vec4 part;  ///< x, y, width, height, pixels

out vec2 uv;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 place = (mix(box.xy, box.zw, corner) - part.xy) / part.zw * 2.0 - 1.0;
    gl_Position = vec4(place.x, -place.y, 0.5, 1.0);
    uv = mix(texels.xy, texels.zw, corner);
}
