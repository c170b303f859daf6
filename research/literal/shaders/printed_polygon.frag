#version 450 core
// The distance from a texel's surface point to a site: the norm of the distance vector, which is affine in
// the texel (Lemma 1). It is evaluated here rather than interpolated from the polygon's corners, because
// rasterisers snap corners to a grid of 1/256 texel and interpolate between the snapped positions. As the
// paper has it, if `interpolate` is set.

uniform bool interpolate;  // use the vectors of the corners

flat in vec2 origin;  // texel coordinates at which the affine functions have their base values
flat in vec3 distance_vector, vector_du, vector_dv;
flat in vec3 walls[5];  // (value, d/du, d/dv): the region is where none is negative
flat in uint winner;  // the value that stands for the site
noperspective in vec3 interpolated_vector;

layout(location = 0) out uint closest;
layout(location = 1) out vec4 vector_drawn;  // stored only if it is not recomputed

void main() {
  const vec2 o = gl_FragCoord.xy - origin;
  for (int i = 0; i < walls.length(); ++i)
    if (walls[i].x + dot(walls[i].yz, o) < 0.0) discard;
  closest = winner;
  const vec3 vector = interpolate ? interpolated_vector : distance_vector + o.x * vector_du + o.y * vector_dv;
  vector_drawn = vec4(vector, 0.0);
  gl_FragDepth = length(vector);
}
