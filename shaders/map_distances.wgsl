// The distances of a map, which stay on the device: of each point the least one of the faces in its list, or of all where the
// list is incomplete. Behind shaders/nearest_first.wgsl and shaders/part.wgsl; runs after shaders/closest_faces.wgsl.

@group(0) @binding(6) var<storage, read_write> distances: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= part.count) {
    return;
  }
  search_listed(i);
  let distance = sqrt(nearest);
  let place = part.first + i;
  distances[place] = min(distance, select(kHuge, distances[place], part.has_distances != 0u));
}
