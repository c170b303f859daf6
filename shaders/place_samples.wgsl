// The samples of a map as points, from the vertices of their faces. Behind shaders/part.wgsl.

struct Sample {
  a: u32,  // vertices of the face
  b: u32,
  c: u32,
  s: f32,  // weights of b and c
  t: f32,
}

@group(0) @binding(0) var<storage, read> samples: array<Sample>;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(4) var<storage, read_write> points: array<vec4f>;

fn vertex(i: u32) -> vec3f {
  return vec3f(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= part.count) {
    points[i] = vec4f(0.0, 0.0, 0.0, -1.0);  // fills the last tile
    return;
  }
  let sample = samples[part.first + i];
  let a = vertex(sample.a);
  let p = a + sample.s * (vertex(sample.b) - a) + sample.t * (vertex(sample.c) - a);
  points[i] = vec4f(p, 1e18);
}
