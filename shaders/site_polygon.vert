#version 450 core
// A corner of a site's polygon, in texels of the map. What is the same over the polygon comes from a table.

uniform float resolution;
uniform uint first_polygon;  // of the corners, in the table
uniform usamplerBuffer polygons;  // six texels a polygon: RasterPolygon. Bits: a float of them could be flushed.

layout(location = 0) in vec2 corner;
layout(location = 1) in uint polygon;

flat out vec2 origin;
flat out vec3 distance_vector, vector_du, vector_dv;
flat out vec3 wall_0, wall_1, wall_2;
flat out uint face, domain;

void main() {
  const int first = 6 * int(polygon - first_polygon);
  const uvec4 a = texelFetch(polygons, first);
  const uvec4 b = texelFetch(polygons, first + 1);
  const uvec4 c = texelFetch(polygons, first + 2);
  const uvec4 d = texelFetch(polygons, first + 3);
  const uvec4 e = texelFetch(polygons, first + 4);
  const uvec4 f = texelFetch(polygons, first + 5);
  distance_vector = uintBitsToFloat(a.xyz);
  vector_du = uintBitsToFloat(b.xyz);
  vector_dv = uintBitsToFloat(c.xyz);
  wall_0 = uintBitsToFloat(d.xyz);
  wall_1 = uintBitsToFloat(e.xyz);
  wall_2 = uintBitsToFloat(f.xyz);
  origin = uintBitsToFloat(uvec2(a.w, b.w));
  face = c.w;
  domain = d.w;
  gl_Position = vec4(2.0 * corner / resolution - 1.0, 0.0, 1.0);
}
