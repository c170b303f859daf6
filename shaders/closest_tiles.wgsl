// The faces that may be closest to each of 64 points that are neighbours: one search of the tree for all of them, by levels,
// gathers the faces that may be closest to any point of the ball around them; each invocation compares some of these with all
// points. docs/design/gpu.md derives the bounds. Behind shaders/faces.wgsl.

const kOpen = 512u;  // nodes of a level, and leaves
const kList = 512u;  // faces, of a tile
const kShort = 256u;  // faces, of a quarter
const kWidth = 8u;  // faces that are compared with the same point at a time

@group(0) @binding(6) var<storage, read> tiles: array<Tile>;

var<workgroup> nodes_of_level: array<array<u32, kOpen>, 2>;
var<workgroup> short_list: array<u32, 4u * kShort>;
var<workgroup> leaf_list: array<u32, kOpen>;
var<workgroup> list: array<u32, kList>;
var<workgroup> level_count: array<atomic<u32>, 2>;
var<workgroup> leaf_count: atomic<u32>;
var<workgroup> list_count: atomic<u32>;
var<workgroup> short_count: array<atomic<u32>, 4>;  // of the faces of a quarter
var<workgroup> best: array<atomic<u32>, 4>;         // the square, truncated, and the place in the list
var<workgroup> tested: atomic<u32>;
var<workgroup> positions: array<vec3f, kTile>;
var<workgroup> limits: array<atomic<u32>, kTile>;     // squared, as bits, as all squares here
var<workgroup> counts: array<atomic<u32>, kTile>;     // of the lists of points
var<workgroup> left_out: array<atomic<u32>, kTile>;   // the least square of the faces that had no room in a list
var<workgroup> uniform_value: u32;

// A value of the first invocation, which is alike for all after a barrier, so that loops and returns can depend on it.
fn same_for_all(lane: u32, value: u32) -> u32 {
  workgroupBarrier();
  if (lane == 0u) {
    uniform_value = value;
  }
  return workgroupUniformLoad(&uniform_value);
}

// A face of O2 whose point `a` is near the middle c of a ball: no face is closest to a point of the ball unless it is within
// these distances.
struct Near {
  a: vec3f,
  shell: f32,   // from the middle, for all faces
  square: f32,  // to this, 2 radius |b − a| of the farthest point b of a face, or of its box, is added
}
fn near_by(face: Face, c: vec3f, radius: f32, tile: Points) -> Near {
  let a = closest_of_face(face, c);
  let distance = length(c - a);
  let slack = tile.error + 4e-6 * distance;
  return Near(a, min(distance + 2.0 * radius, tile.within + radius),
              distance * distance + 2.0 * slack * (distance + radius) + slack * slack);
}
fn squared_reach(near: Near, radius: f32, farthest: f32, error: f32) -> f32 {
  let reach = farther(min(near.shell, sqrt(near.square + 2.0 * radius * farthest)), error);
  return reach * reach;
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  let i = group.x * kTile + lane;
  let point = points[i];
  let used = point.w >= 0.0;
  let tile = tiles[group.x].all;
  if (tile.face == kUnused) {
    results[i * kResult] = select(kIncomplete, 0u, used);
    return;
  }
  let near = near_by(faces[tile.face], tile.centre, tile.radius, tile);
  if (lane == 0u) {
    atomicStore(&level_count[0], 1u);
    atomicStore(&level_count[1], 0u);
    atomicStore(&leaf_count, 0u);
    atomicStore(&list_count, 0u);
    atomicStore(&tested, tile.counts & 0xffffu);
    for (var q = 0u; q < 4u; q += 1u) {
      atomicStore(&short_count[q], 0u);
      atomicStore(&best[q], 0xffffffffu);
    }
    nodes_of_level[0][0] = 0u;
  }

  // Leaves, level by level.
  var level = 0u;
  var visited = tile.counts >> 16u;
  loop {
    let count = same_for_all(lane, atomicLoad(&level_count[level]));
    if (count == 0u || count > kOpen) {
      break;
    }
    for (var item = lane; item < 8u * count; item += kTile) {
      let child = boxes[8u * nodes_of_level[level][item / 8u] + item % 8u];
      let far = max(abs(near.a - child.lo), abs(near.a - child.hi));
      if (child.number == kUnused || squared_to_box(child, tile.centre) > squared_reach(near, tile.radius, length(far), tile.error)) {
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
        }
      }
    }
    workgroupBarrier();
    visited += count;
    if (lane == 0u) {
      atomicStore(&level_count[level], 0u);
    }
    level = 1u - level;
  }
  let leaves_found = same_for_all(lane, atomicLoad(&leaf_count));
  let left = same_for_all(lane, atomicLoad(&level_count[level]));
  if (left > kOpen || leaves_found > kOpen) {
    results[i * kResult] = kAlone;
    return;
  }

  // The faces that may be closest to a point of the ball.
  for (var item = lane; item < 8u * leaves_found; item += kTile) {
    let leaf = leaf_list[item / 8u];
    let number = leaves[leaf] + item % 8u;
    if (number >= leaves[leaf + 1u]) {
      continue;
    }
    atomicAdd(&tested, 1u);
    let face = faces[number];
    if (squared_to_face(face, tile.centre) <= squared_reach(near, tile.radius, farthest_of_face(face, near.a), tile.error)) {
      let place = atomicAdd(&list_count, 1u);
      if (place < kList) {
        list[place] = number;
      }
    }
  }
  workgroupBarrier();
  let listed = same_for_all(lane, atomicLoad(&list_count));
  if (listed > kList) {
    results[i * kResult] = kAlone;
    return;
  }

  // Of these, the ones that may be closest to a point of the ball around a quarter of the points; and the one that is nearest to
  // its middle, or nearly so.
  let quarter = lane / kQuarter;
  let in_quarter = lane % kQuarter;
  let ball = tiles[group.x].quarters[quarter];
  for (var k = in_quarter; k < listed; k += kQuarter) {
    let square = squared_to_face(faces[list[k]], ball.xyz);
    atomicMin(&best[quarter], (bitcast<u32>(square) & ~(kList - 1u)) | k);
  }
  workgroupBarrier();
  let nearest = list[atomicLoad(&best[quarter]) % kList];
  let near_quarter = near_by(faces[nearest], ball.xyz, ball.w, tile);
  for (var k = in_quarter; k < listed; k += kQuarter) {
    let face = faces[list[k]];
    if (squared_to_face(face, ball.xyz) <=
        squared_reach(near_quarter, ball.w, farthest_of_face(face, near_quarter.a), tile.error)) {
      let place = atomicAdd(&short_count[quarter], 1u);
      if (place < kShort) {
        short_list[quarter * kShort + place] = list[k];
      }
    }
  }

  // The limits of the points begin with that face.
  let p = point.xyz;
  let own_error = error_at(max(max(abs(p.x), abs(p.y)), abs(p.z)));
  let within = point.w + own_error;
  let from_nearest = farther(sqrt(squared_to_face(faces[nearest], p)), own_error);
  positions[lane] = p;
  atomicStore(&limits[lane], select(0u, bitcast<u32>(min(within * within, from_nearest * from_nearest)), used));
  atomicStore(&counts[lane], 0u);
  atomicStore(&left_out[lane], bitcast<u32>(kHuge));
  workgroupBarrier();

  // Each invocation compares a face with some of the points, as a face takes more loads than a point.
  let shortened = atomicLoad(&short_count[quarter]);
  let first_point = quarter * kQuarter + in_quarter / kWidth;
  if (shortened <= kShort) {
    for (var item = in_quarter % kWidth; item < shortened; item += kWidth) {
      let number = short_list[quarter * kShort + item];
      let face = faces[number];
      for (var k = first_point; k < (quarter + 1u) * kQuarter; k += kQuarter / kWidth) {
        let at = positions[k];
        let square = squared_to_face(face, at);
        if (square > bitcast<f32>(atomicLoad(&limits[k]))) {
          continue;
        }
        let reach = farther(sqrt(square), error_at(max(max(abs(at.x), abs(at.y)), abs(at.z))));
        atomicMin(&limits[k], bitcast<u32>(reach * reach));
        let place = atomicAdd(&counts[k], 1u);
        if (place < kMost) {
          results[(group.x * kTile + k) * kResult + 1u + place] = number;
        } else {
          atomicMin(&left_out[k], bitcast<u32>(square));
        }
      }
    }
  }
  storageBarrier();
  workgroupBarrier();
  if (!used || shortened > kShort) {
    results[i * kResult] = select(kIncomplete, kAlone, used);
    return;
  }
  var count = atomicLoad(&counts[lane]);
  var compared = 1u + shortened + (atomicLoad(&tested) + lane) / kTile + 2u * listed / kQuarter;
  let limit = bitcast<f32>(atomicLoad(&limits[lane]));
  var incomplete = false;
  if (count > kMost && bitcast<f32>(atomicLoad(&left_out[lane])) <= limit) {
    // A list that was full before the limit was least is made again.
    compared += shortened;
    count = 0u;
    for (var k = quarter * kShort; k < quarter * kShort + shortened; k += 1u) {
      if (squared_to_face(faces[short_list[k]], p) <= limit) {
        count += 1u;
        if (count <= kMost) {
          results[i * kResult + count] = short_list[k];
        }
      }
    }
    incomplete = count > kMost;
  }
  results[i * kResult] = head_of(min(count, kMost), incomplete, (visited + lane) / kTile, compared);
}
