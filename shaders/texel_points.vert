#version 450 core
// A texel of a face, as a point: drawing these sets the stencil of exactly the face's texels.

uniform float resolution;

layout(location = 0) in uint texel;

void main() {
  const uint side = uint(resolution);
  const vec2 centre = vec2(texel % side, texel / side) + 0.5;
  gl_Position = vec4(2.0 * centre / resolution - 1.0, 0.0, 1.0);
}
