#version 450 core
// One triangle that covers the whole picture: draw three vertices without any attribute.
//
// The position has depth 0, the far end of reversed depth: with the depth test GL_GEQUAL a pass that draws this fills
// only what nothing has been drawn to.

out vec2 ndc;  // -1..1 over the picture, y up

void main() {
    ndc = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(ndc, 0.0, 1.0);
}
