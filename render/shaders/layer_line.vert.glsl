#version 450 core
// Pieces of draped lines: four vertices each, the corners of a rectangle around it. Places are pixels of the whole
// picture, so that its parts cannot differ.

layout(location = 0) in vec3 from;  ///< pixels from the top left, depth
layout(location = 1) in vec3 to;

uniform vec4 part;   ///< x, y, width, height, pixels
uniform float half_width;

out vec2 pixel;
flat out vec3 start;
flat out vec3 end;

void main() {
    vec2 along = to.xy - from.xy;
    float size = length(along);
    along = size > 0.0 ? along / size : vec2(1.0, 0.0);
    bool at_end = (gl_VertexID & 1) != 0;
    pixel = (at_end ? to.xy : from.xy) +
            (half_width + 1.0) * ((at_end ? along : -along) + ((gl_VertexID & 2) != 0 ? 1.0 : -1.0) * vec2(-along.y, along.x));
    vec2 place = (pixel - part.xy) / part.zw * 2.0 - 1.0;
    gl_Position = vec4(place.x, -place.y, 0.5, 1.0);
    start = from;
    end = to;
}
