// The faces that may be closest to each point of the tiles whose points are too far from each other to share a search
// (shaders/closest_tiles.wgsl). Behind shaders/nearest_first.wgsl.

@group(0) @binding(6) var<storage, read> tiles: array<Tile>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  let i = group.x * kTile + lane;
  if ((results[i * kResult] & kAlone) == 0u) {
    return;
  }
  let point = points[i];
  if (point.w < 0.0) {
    results[i * kResult] = kIncomplete;
    return;
  }
  let p = point.xyz;
  let error = error_at(max(max(abs(p.x), abs(p.y)), abs(p.z)));
  let within = point.w + error;
  let from_known = farther(sqrt(squared_to_face(faces[tiles[group.x].all.face], p)), error);
  search_tree(p, min(within * within, from_known * from_known), error);
  let incomplete = overflow || left_out <= limit;
  results[i * kResult] = head_of(count, incomplete, visited, tested) | kAlone;
  for (var k = 0u; k < count; k += 1u) {
    results[i * kResult + 1u + k] = list[k];
  }
}
