#version 450 core
// One colour, or one alpha, wherever it is asked for.

uniform vec4 paint;

layout(location = 0) out vec4 color;

void main() {
    color = paint;
}
