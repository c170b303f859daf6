// The boxes of the nodes of one level of the tree for moved vertices, after those of all deeper ones: an invocation for each
// child. Behind shaders/faces.wgsl, shaders/part.wgsl and shaders/face_sites.wgsl.

// More than what the vertices and these boxes are rounded by, of coordinates up to 1.
const kOutwards = 2e-7;

@group(0) @binding(5) var<storage, read> nodes: array<u32>;  // by their levels
@group(0) @binding(6) var<storage, read_write> refitted_boxes: array<ChildBox>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  for (var i = id.x; i < 8u * part.count; i += 64u * groups.x) {
    let place = 8u * nodes[part.first + i / 8u] + i % 8u;
    let child = refitted_boxes[place].number;
    if (child == kUnused) {
      continue;
    }
    var lo = vec3f(kHuge);
    var hi = vec3f(-kHuge);
    if ((child & kLeaf) != 0u) {
      let leaf = child & ~kLeaf;
      for (var f = leaves[leaf]; f < leaves[leaf + 1u]; f += 1u) {
        for (var k = 0u; k < 3u; k += 1u) {
          let p = vertex(face_sites[f].vertices[k]);
          lo = min(lo, p - kOutwards);
          hi = max(hi, p + kOutwards);
        }
      }
    } else {
      for (var k = 8u * child; k < 8u * child + 8u; k += 1u) {
        if (refitted_boxes[k].number != kUnused) {
          lo = min(lo, refitted_boxes[k].lo);
          hi = max(hi, refitted_boxes[k].hi);
        }
      }
    }
    refitted_boxes[place].lo = lo;
    refitted_boxes[place].hi = hi;
  }
}
