#version 450 core
// The distance from a texel's surface point to a site: the norm of the distance vector, which is affine in
// the texel (Lemma 1). It is evaluated here rather than interpolated from the polygon's corners, because
// rasterisers snap corners to a grid of 1/256 texel and interpolate between the snapped positions.

uniform bool by_owner;  // whether fragments test the owner of their texel
uniform usampler2D owner;  // the domain that owns each texel

flat in vec2 origin;  // texel coordinates at which the affine functions have their base values
flat in vec3 distance_vector, vector_du, vector_dv;
flat in vec3 walls[5];  // (value, d/du, d/dv): the region is where none is negative
flat in uint winner, domain;  // the value that stands for the site, and the domain being drawn

layout(binding = 0, offset = 0) uniform atomic_uint fragments;

layout(location = 0) out uint closest;

void main() {
  if (by_owner && texelFetch(owner, ivec2(gl_FragCoord.xy), 0).r != domain) discard;
  const vec2 o = gl_FragCoord.xy - origin;
  for (int i = 0; i < walls.length(); ++i)
    if (walls[i].x + dot(walls[i].yz, o) < 0.0) discard;
  atomicCounterIncrement(fragments);
  closest = winner;
  gl_FragDepth = length(distance_vector + o.x * vector_du + o.y * vector_dv);
}
