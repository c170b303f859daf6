// The faces that may be closest to each point of some tiles of 64: a search of the tree for each point, nearest box first, with
// a stack for each invocation. For tiles whose points are too far from each other to share a search (shaders/closest_tiles.wgsl).
// Each result has a face that is near, from there. Behind shaders/faces.wgsl.

@group(0) @binding(6) var<storage, read> tiles: array<u32>;

const kStack = 128u;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  let i = tiles[group.x] * 64u + lane;
  let p = points[i].xyz;
  if (points[i].w < 0.0) {
    results[i * kResult] = kIncomplete;
    return;
  }
  let error = error_at(max(max(abs(p.x), abs(p.y)), abs(p.z)));
  let within = points[i].w + error;
  var limit = within * within;
  let from_known = farther(sqrt(squared_to_face(results[i * kResult + 1u], p)), error);
  limit = min(limit, from_known * from_known);

  var stack_child: array<u32, kStack>;
  var stack_bound: array<f32, kStack>;
  var open = 1u;  // on the stack: the root
  var list: array<u32, kMost>;
  var squared: array<f32, kMost>;
  var count = 0u;
  var left_out = bitcast<f32>(kInfinity);  // the least squared distance of the faces that had no room in the list
  var overflow = false;
  var visited = 0u;
  var tested = 0u;

  while (open > 0u) {
    open -= 1u;
    if (stack_bound[open] > limit) {
      continue;
    }
    let child = stack_child[open];
    if ((child & kLeaf) == 0u) {
      visited += 1u;
      let bottom = open;
      for (var k = 8u * child; k < 8u * child + 8u; k += 1u) {
        let box = boxes[k];
        let bound = squared_to_box(box, p);
        if (box.number == kUnused || bound > limit) {
          continue;
        }
        if (open == kStack) {
          overflow = true;
          continue;
        }
        // The farthest child is at the bottom.
        var place = open;
        while (place > bottom && stack_bound[place - 1u] < bound) {
          stack_bound[place] = stack_bound[place - 1u];
          stack_child[place] = stack_child[place - 1u];
          place -= 1u;
        }
        stack_bound[place] = bound;
        stack_child[place] = box.number;
        open += 1u;
      }
      continue;
    }
    let leaf = child & ~kLeaf;
    let end = leaves[leaf + 1u];
    for (var f = leaves[leaf]; f < end; f += 1u) {
      tested += 1u;
      let distance = squared_to_face(f, p);
      if (distance > limit) {
        continue;
      }
      let reach = farther(sqrt(distance), error);
      if (reach * reach < limit) {
        limit = reach * reach;
        var kept = 0u;
        for (var k = 0u; k < count; k += 1u) {
          if (squared[k] <= limit) {
            squared[kept] = squared[k];
            list[kept] = list[k];
            kept += 1u;
          }
        }
        count = kept;
      }
      if (count < kMost) {
        list[count] = f;
        squared[count] = distance;
        count += 1u;
      } else {
        left_out = min(left_out, distance);
      }
    }
  }

  let incomplete = overflow || left_out <= limit;
  let counts = (min(visited, 0xfffu) << 6u) | (min(tested, 0x3fffu) << 18u);
  results[i * kResult] = count | select(0u, kIncomplete, incomplete) | counts;
  for (var k = 0u; k < count; k += 1u) {
    results[i * kResult + 1u + k] = list[k];
  }
}
