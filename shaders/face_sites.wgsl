// What refits of O2 keep: the sites of its faces; and what they begin with, its vertices.

struct FaceSites {
  vertices: array<u32, 3>,
  edges: array<u32, 3>,  // from each corner to the next one
}

@group(0) @binding(8) var<storage, read> face_sites: array<FaceSites>;
@group(0) @binding(9) var<storage, read> positions: array<f32>;

fn vertex(i: u32) -> vec3f {
  return vec3f(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
}
