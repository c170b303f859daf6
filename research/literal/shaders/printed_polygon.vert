#version 450 core
// A corner of a site's polygon, in texels of the map. Data common to the polygon comes from a table.

uniform vec2 size;  // of the image, in texels
uniform uint first_polygon;  // of these corners, in the table
uniform usamplerBuffer polygons;  // seven texels per polygon (RasterPolygon), as bits: denormal floats could be flushed

layout(location = 0) in vec2 corner;
layout(location = 1) in uint polygon;
layout(location = 2) in vec3 corner_vector;  // if vectors are interpolated

flat out vec2 origin;
flat out vec3 distance_vector, vector_du, vector_dv;
flat out vec3 walls[5];
flat out uint winner;
noperspective out vec3 interpolated_vector;

void main() {
  const int first = 7 * int(polygon - first_polygon);
  const uvec4 a = texelFetch(polygons, first);
  const uvec4 b = texelFetch(polygons, first + 1);
  const uvec4 c = texelFetch(polygons, first + 2);
  const uvec4 d = texelFetch(polygons, first + 3);
  const uvec4 e = texelFetch(polygons, first + 4);
  const uvec4 f = texelFetch(polygons, first + 5);
  const uvec4 g = texelFetch(polygons, first + 6);
  distance_vector = uintBitsToFloat(a.xyz);
  vector_du = uintBitsToFloat(b.xyz);
  vector_dv = uintBitsToFloat(c.xyz);
  walls[0] = uintBitsToFloat(d.xyz);
  walls[1] = uintBitsToFloat(uvec3(d.w, e.xy));
  walls[2] = uintBitsToFloat(uvec3(e.zw, f.x));
  walls[3] = uintBitsToFloat(f.yzw);
  walls[4] = uintBitsToFloat(g.xyz);
  origin = uintBitsToFloat(uvec2(a.w, b.w));
  winner = c.w;
  interpolated_vector = corner_vector;
  gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
