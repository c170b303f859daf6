#version 450 core
// A corner of a site's polygon, in texels of the map. What is the same over the polygon comes from a table.

uniform float resolution;
uniform samplerBuffer polygons;  // six texels a polygon: see RasterPolygon in planar_domain.h

layout(location = 0) in vec2 corner;
layout(location = 1) in uint polygon;

flat out vec2 origin;
flat out vec3 distance_vector, vector_du, vector_dv;
flat out vec3 wall_0, wall_1, wall_2;
flat out uint site, domain;

void main() {
  const int first = 6 * int(polygon);
  const vec4 a = texelFetch(polygons, first);
  const vec4 b = texelFetch(polygons, first + 1);
  const vec4 c = texelFetch(polygons, first + 2);
  const vec4 d = texelFetch(polygons, first + 3);
  const vec4 e = texelFetch(polygons, first + 4);
  const vec4 f = texelFetch(polygons, first + 5);
  distance_vector = a.xyz;
  vector_du = b.xyz;
  vector_dv = c.xyz;
  wall_0 = d.xyz;
  wall_1 = e.xyz;
  wall_2 = f.xyz;
  origin = vec2(a.w, b.w);
  site = floatBitsToUint(c.w);
  domain = floatBitsToUint(d.w);
  gl_Position = vec4(2.0 * corner / resolution - 1.0, 0.0, 1.0);
}
