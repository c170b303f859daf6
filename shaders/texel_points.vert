#version 450 core
// A texel of a face, as a point: drawing these sets the stencil of exactly the face's texels.

uniform vec2 size;  // of the image, in texels

layout(location = 0) in uint texel;

void main() {
  const uint columns = uint(size.x);
  const vec2 centre = vec2(texel % columns, texel / columns) + 0.5;
  gl_Position = vec4(2.0 * centre / size - 1.0, 0.0, 1.0);
}
