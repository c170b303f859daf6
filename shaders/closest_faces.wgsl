// The faces that may be closest to each point: a search of the eight-wide tree, nearest box first, with a stack for each
// invocation, and a list of all faces within the error bound of the closest one. docs/design/gpu.md derives the bounds.

// tree::WideTree::Node. A child with the highest bit is a leaf.
struct Node {
  lo: array<vec4f, 6>,  // x of eight boxes, then y, then z
  hi: array<vec4f, 6>,
  child: array<vec4u, 2>,
  source: array<vec4u, 2>,
  count: u32,
  leaves: u32,
  padding: array<u32, 6>,
}

// A triangle in the frame of its longest side AB (sites/face_frames.h).
struct Face {
  origin_length: vec4f,  // A; |AB|
  along_ac: vec4f,       // the direction of AB; that of AC along AB
  beside_ac: vec4f,      // the direction beside AB in the plane; that of AC beside AB
  normal_ac: vec4f,      // the normal; |AC|
  bc: vec4f,             // the direction of BC along and beside AB; |BC|
}

struct Errors {
  by_coordinate: f32,  // of each unit of the largest coordinate of a point
  constant: f32,
  padding: vec2f,
}

@group(0) @binding(0) var<uniform> errors: Errors;
@group(0) @binding(1) var<storage, read> nodes: array<Node>;
@group(0) @binding(2) var<storage, read> leaves: array<u32>;  // the first face of each leaf, and an end
@group(0) @binding(3) var<storage, read> faces: array<Face>;
@group(0) @binding(4) var<storage, read> points: array<vec4f>;  // and the largest distance; negative: skip the point
@group(0) @binding(5) var<storage, read_write> results: array<u32>;

const kLeaf = 0x80000000u;
const kStack = 128u;
const kMost = 15u;     // faces in a list
const kResult = 16u;   // numbers of a point: the head, then its list
const kIncomplete = 16u;
const kFarther = 1.000006;
const kNone = 0x7f800000u;

fn minus_clamped(t: f32, end: f32) -> f32 {
  return t - clamp(t, 0.0, end);
}

// As squared_to_faces() of closest/face_distances-inl.h.
fn squared_to_face(number: u32, p: vec3f) -> f32 {
  let face = faces[number];
  let r = p - face.origin_length.xyz;
  let u = dot(r, face.along_ac.xyz);
  let v = dot(r, face.beside_ac.xyz);
  let h = dot(r, face.normal_ac.xyz);
  let length = face.origin_length.w;
  let e = minus_clamped(u, length);
  let ac = vec2f(face.along_ac.w, face.beside_ac.w);
  let left_of_ac = v * ac.x - u * ac.y;
  let e_ac = minus_clamped(u * ac.x + v * ac.y, face.normal_ac.w);
  let w = u - length;
  let left_of_bc = v * face.bc.x - w * face.bc.y;
  let e_bc = minus_clamped(w * face.bc.x + v * face.bc.y, face.bc.z);
  let beside = min(e * e + v * v, min(e_ac * e_ac + left_of_ac * left_of_ac, e_bc * e_bc + left_of_bc * left_of_bc));
  let over = min(v, left_of_bc) > 0.0 && left_of_ac < 0.0;
  return h * h + select(beside, 0.0, over);
}

fn squared_to_boxes(n: u32, half: u32, p: vec3f) -> vec4f {
  let x = p.x - clamp(vec4f(p.x), nodes[n].lo[half], nodes[n].hi[half]);
  let y = p.y - clamp(vec4f(p.y), nodes[n].lo[half + 2u], nodes[n].hi[half + 2u]);
  let z = p.z - clamp(vec4f(p.z), nodes[n].lo[half + 4u], nodes[n].hi[half + 4u]);
  return x * x + y * y + z * z;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= arrayLength(&points) || i * kResult >= arrayLength(&results)) {
    return;
  }
  let p = points[i].xyz;
  if (points[i].w < 0.0) {
    results[i * kResult] = kIncomplete;
    return;
  }
  let largest = max(max(abs(p.x), abs(p.y)), max(abs(p.z), 1.0));
  let error = errors.by_coordinate * largest + errors.constant;
  let within = points[i].w + error;
  var limit = within * within;

  var stack_child: array<u32, kStack>;
  var stack_bound: array<f32, kStack>;
  var open = 1u;  // on the stack: the root
  var list: array<u32, kMost>;
  var squared: array<f32, kMost>;
  var count = 0u;
  var left_out = bitcast<f32>(kNone);  // the least squared distance of the faces that had no room in the list
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
      let in_use = nodes[child].count;
      let bottom = open;
      for (var half = 0u; half < 2u; half += 1u) {
        let bounds = squared_to_boxes(child, half, p);
        let children = nodes[child].child[half];
        for (var k = 0u; k < 4u; k += 1u) {
          let bound = bounds[k];
          if (half * 4u + k >= in_use || bound > limit) {
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
          stack_child[place] = children[k];
          open += 1u;
        }
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
      let reach = sqrt(distance) * kFarther + error;
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
  let counts = (min(visited, 0x1fffu) << 5u) | (min(tested, 0x3fffu) << 18u);
  results[i * kResult] = count | select(0u, kIncomplete, incomplete) | counts;
  for (var k = 0u; k < count; k += 1u) {
    results[i * kResult + 1u + k] = list[k];
  }
}
