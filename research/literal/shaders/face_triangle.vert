#version 450 core
// A corner of a face in the atlas, in texels: the paper sets the stencil of a face by drawing its triangle.

uniform vec2 size;  // of the image, in texels

layout(location = 0) in vec2 corner;

void main() {
  gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
