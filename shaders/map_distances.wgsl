// The distances of a map, which stay on the device: of each point the least one of the faces in its list, or of all where the
// list is incomplete. Behind shaders/nearest_first.wgsl and shaders/part.wgsl; runs after shaders/closest_faces.wgsl.

@group(0) @binding(6) var<storage, read_write> distances: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= part.count) {
    return;
  }
  let p = points[i].xyz;
  let head = results[i * kResult];
  let listed = head & 15u;
  var least = kHuge;
  for (var k = 1u; k <= listed; k += 1u) {
    least = min(least, squared_to_face(faces[results[i * kResult + k]], p));
  }
  if ((head & kIncomplete) != 0u) {
    search_tree(p, least, 0.0);
    least = min(least, nearest);
  }
  let distance = sqrt(least);
  let place = part.first + i;
  distances[place] = min(distance, select(kHuge, distances[place], part.has_distances != 0u));
}
