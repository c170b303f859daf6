// The faces that may be closest to each of 64 points that are neighbours: one search of the tree for all of them, by levels,
// gathers the faces that may be closest to any point of a ball around them, which each invocation then compares with its
// point. docs/design/gpu.md derives the bounds. Behind shaders/faces.wgsl.

const kTile = 64u;
const kOpen = 512u;  // nodes of a level, and leaves
const kList = 256u;  // faces

var<workgroup> low: array<atomic<u32>, 3>;   // of the points, by key()
var<workgroup> high: array<atomic<u32>, 3>;
var<workgroup> squared_radius: atomic<u32>;  // around the middle of the points; as bits, as all squares here
var<workgroup> squared_bound: atomic<u32>;   // no face beyond this is closest to the middle
var<workgroup> best: atomic<u32>;            // the leaf, then the face, that is nearest to the middle
var<workgroup> nodes_of_level: array<array<u32, kOpen>, 2>;
var<workgroup> leaf_list: array<u32, kOpen>;
var<workgroup> leaf_square: array<f32, kOpen>;
var<workgroup> list: array<u32, kList>;
var<workgroup> list_square: array<f32, kList>;
var<workgroup> short_list: array<u32, kList>;
var<workgroup> level_count: array<atomic<u32>, 2>;
var<workgroup> leaf_count: atomic<u32>;
var<workgroup> list_count: atomic<u32>;
var<workgroup> short_count: atomic<u32>;
var<workgroup> visited: atomic<u32>;
var<workgroup> tested: atomic<u32>;
var<workgroup> uniform_value: u32;

// Orders numbers of any sign as unsigned integers.
fn key(x: f32) -> u32 {
  let bits = bitcast<u32>(x);
  return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}
fn number_of(key: u32) -> f32 {
  return bitcast<f32>(select(~key, key & 0x7fffffffu, (key & 0x80000000u) != 0u));
}

// A value of the first invocation, which is alike for all after a barrier, so that loops and returns can depend on it.
fn same_for_all(lane: u32, value: u32) -> u32 {
  workgroupBarrier();
  if (lane == 0u) {
    uniform_value = value;
  }
  return workgroupUniformLoad(&uniform_value);
}

fn squared_to_far_corner(lo: vec3f, hi: vec3f, p: vec3f) -> f32 {
  let far = max(abs(p - lo), abs(p - hi));
  return dot(far, far);
}

// A face of O2 whose point `a` is near the middle c of a ball: no face is closest to a point of the ball unless it is within
// these distances.
struct Near {
  face: u32,
  a: vec3f,
  shell: f32,   // from the middle, for all faces
  square: f32,  // to this, 2 radius |b − a| of the farthest point b of the face is added
}
fn near_by(face: u32, c: vec3f, radius: f32, error: f32) -> Near {
  let a = closest_of_face(face, c);
  let distance = length(c - a);
  let slack = error + 2e-6 * distance;
  return Near(face, a, distance + 2.0 * radius, distance * distance + 2.0 * slack * (distance + radius) + slack * slack);
}
fn squared_reach(near: Near, radius: f32, farthest: f32, error: f32) -> f32 {
  let reach = farther(min(near.shell, sqrt(near.square + 2.0 * radius * farthest)), error);
  return reach * reach;
}

// The points beside each other are searched for one by one, from a face of O2 that may be near.
fn leave_alone(point: u32, face: u32) {
  results[point * kResult] = kIncomplete | kAlone;
  results[point * kResult + 1u] = face;
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  let i = group.x * kTile + lane;
  let point = points[i];
  let p = point.xyz;
  let used = point.w >= 0.0;

  // The ball around the points.
  if (lane < 3u) {
    atomicStore(&low[lane], 0xffffffffu);
    atomicStore(&high[lane], 0u);
    atomicStore(&squared_radius, 0u);
    atomicStore(&squared_bound, kInfinity);
    atomicStore(&best, 0xffffffffu);
    atomicStore(&level_count[0], 1u);
    atomicStore(&level_count[1], 0u);
    atomicStore(&leaf_count, 0u);
    atomicStore(&list_count, 0u);
    atomicStore(&short_count, 0u);
    atomicStore(&visited, 0u);
    atomicStore(&tested, 0u);
    nodes_of_level[0][0] = 0u;
  }
  workgroupBarrier();
  if (used) {
    for (var k = 0u; k < 3u; k += 1u) {
      atomicMin(&low[k], key(p[k]));
      atomicMax(&high[k], key(p[k]));
    }
  }
  workgroupBarrier();
  let lo = vec3f(number_of(atomicLoad(&low[0])), number_of(atomicLoad(&low[1])), number_of(atomicLoad(&low[2])));
  let hi = vec3f(number_of(atomicLoad(&high[0])), number_of(atomicLoad(&high[1])), number_of(atomicLoad(&high[2])));
  if (same_for_all(lane, select(0u, 1u, atomicLoad(&high[0]) == 0u)) == 1u) {
    results[i * kResult] = kIncomplete;
    return;
  }
  let c = 0.5 * (lo + hi);
  if (used) {
    let from_middle = p - c;
    atomicMax(&squared_radius, bitcast<u32>(dot(from_middle, from_middle)));
  }
  workgroupBarrier();
  let radius = sqrt(bitcast<f32>(atomicLoad(&squared_radius))) * kFarther;
  let outermost = max(abs(lo), abs(hi));
  let error = 3.0 * error_at(max(max(outermost.x, outermost.y), outermost.z));

  // Leaves, level by level.
  var level = 0u;
  loop {
    let count = same_for_all(lane, atomicLoad(&level_count[level]));
    if (count == 0u || count > kOpen) {
      break;
    }
    for (var item = lane; item < 8u * count; item += kTile) {
      let child = boxes[8u * nodes_of_level[level][item / 8u] + item % 8u];
      if (child.number == kUnused) {
        continue;
      }
      atomicMin(&squared_bound, bitcast<u32>(squared_to_far_corner(child.lo, child.hi, c)));
      let square = squared_to_box(child, c);
      let reach = farther(sqrt(bitcast<f32>(atomicLoad(&squared_bound))) + 2.0 * radius, error);
      if (square > reach * reach) {
        continue;
      }
      if ((child.number & kLeaf) == 0u) {
        let place = atomicAdd(&level_count[1u - level], 1u);
        if (place < kOpen) {
          nodes_of_level[1u - level][place] = child.number;
        }
      } else {
        let place = atomicAdd(&leaf_count, 1u);
        if (place < kOpen) {
          leaf_list[place] = child.number & ~kLeaf;
          leaf_square[place] = square;
          atomicMin(&best, bitcast<u32>(square));
        }
      }
    }
    workgroupBarrier();
    if (lane == 0u) {
      atomicAdd(&visited, count);
      atomicStore(&level_count[level], 0u);
    }
    level = 1u - level;
  }
  let leaves_found = same_for_all(lane, atomicLoad(&leaf_count));
  let left = same_for_all(lane, atomicLoad(&level_count[level]));
  if (left > kOpen || leaves_found > kOpen) {
    leave_alone(i, 0u);
    return;
  }

  // A point of O2 that is near the middle: that of the faces of the nearest leaf.
  let least = same_for_all(lane, atomicLoad(&best));
  if (lane == 0u) {
    atomicStore(&best, 0xffffffffu);
    atomicStore(&squared_bound, kInfinity);
  }
  workgroupBarrier();
  for (var item = lane; item < leaves_found; item += kTile) {
    if (bitcast<u32>(leaf_square[item]) == least) {
      atomicMin(&best, item);
    }
  }
  workgroupBarrier();
  let nearest = leaf_list[atomicLoad(&best)];
  let face_of_lane = leaves[nearest] + lane;
  var own = kInfinity;
  if (face_of_lane < leaves[nearest + 1u]) {
    own = bitcast<u32>(squared_to_face(face_of_lane, c));
    atomicMin(&squared_bound, own);
  }
  workgroupBarrier();
  if (lane == 0u) {
    atomicStore(&best, 0xffffffffu);
  }
  workgroupBarrier();
  if (own != kInfinity && own == atomicLoad(&squared_bound)) {
    atomicMin(&best, face_of_lane);
  }
  workgroupBarrier();
  let at_first = near_by(atomicLoad(&best), c, radius, error);
  workgroupBarrier();
  if (lane == 0u) {
    atomicStore(&best, 0xffffffffu);
    atomicStore(&squared_bound, kInfinity);
  }
  workgroupBarrier();

  // The faces that may be closest to a point of the ball; then those that may be beside the nearest one.
  for (var item = lane; item < 8u * leaves_found; item += kTile) {
    let leaf = leaf_list[item / 8u];
    let shell = farther(at_first.shell, error);
    if (leaf_square[item / 8u] > shell * shell) {
      continue;
    }
    let face = leaves[leaf] + item % 8u;
    if (face >= leaves[leaf + 1u]) {
      continue;
    }
    atomicAdd(&tested, 1u);
    let square = squared_to_face(face, c);
    if (square <= squared_reach(at_first, radius, farthest_of_face(face, at_first.a), error)) {
      atomicMin(&squared_bound, bitcast<u32>(square));
      let place = atomicAdd(&list_count, 1u);
      if (place < kList) {
        list[place] = face;
        list_square[place] = square;
      }
    }
  }
  workgroupBarrier();
  let listed = same_for_all(lane, atomicLoad(&list_count));
  if (listed == 0u || listed > kList) {
    leave_alone(i, at_first.face);
    return;
  }
  for (var k = lane; k < listed; k += kTile) {
    if (bitcast<u32>(list_square[k]) == atomicLoad(&squared_bound)) {
      atomicMin(&best, list[k]);
    }
  }
  workgroupBarrier();
  let at_nearest = near_by(atomicLoad(&best), c, radius, error);
  for (var k = lane; k < listed; k += kTile) {
    if (list_square[k] <= squared_reach(at_nearest, radius, farthest_of_face(list[k], at_nearest.a), error)) {
      short_list[atomicAdd(&short_count, 1u)] = list[k];
    }
  }
  workgroupBarrier();
  let count = same_for_all(lane, atomicLoad(&short_count));
  if (!used) {
    results[i * kResult] = kIncomplete;
    return;
  }

  // Each point by itself. A list that was full before the limit was least is made again.
  var found = start(p, point.w);
  take_limit(&found, squared_to_face(at_nearest.face, p));
  var compared = 1u;
  for (var again = 0u; again < 2u; again += 1u) {
    for (var k = 0u; k < count; k += 1u) {
      let face = short_list[k];
      let square = squared_to_face(face, p);
      if (square <= found.limit) {
        take(&found, i, face, square);
      }
    }
    compared += count;
    if (found.count < kMost || found.left_out > found.limit) {
      break;
    }
    if (again == 0u) {
      found.count = 0u;
      found.left_out = bitcast<f32>(kInfinity);
    }
  }
  finish(&found, i, (atomicLoad(&visited) + lane) / kTile, compared + (atomicLoad(&tested) + lane) / kTile);
}
