// The frames of the faces of O2 for moved vertices, as those of sites/face_frames.cpp, and a bound of their errors. Behind
// shaders/faces.wgsl, shaders/part.wgsl and shaders/face_sites.wgsl.

// errors.constant for a longest side L: 3.2e-5 R, where a face with this side is in a disc of radius R <= L / sqrt(3).
const kByLongest = 1.85e-5;
// The square of a length that is far below all errors. Less may vanish.
const kNoSquare = 1e-30;

@group(0) @binding(0) var<storage, read_write> refitted_errors: array<atomic<u32>, 4>;
@group(0) @binding(6) var<storage, read_write> refitted_faces: array<Face>;

var<workgroup> longest: atomic<u32>;  // as bits

// A unit vector along v, to rounding: a step of Newton's method corrects the length.
fn unit(v: vec3f) -> vec3f {
  let d = v * inverseSqrt(dot(v, v));
  return d * (1.5 - 0.5 * dot(d, d));
}

// The direction and the length of a side in the plane.
fn side(v: vec2f) -> vec3f {
  let squared = dot(v, v);
  if (squared < kNoSquare) {
    return vec3f(1.0, 0.0, 0.0);
  }
  let d = v * inverseSqrt(squared);
  let direction = d * (1.5 - 0.5 * dot(d, d));
  return vec3f(direction, dot(v, direction));
}

// The direction of v beside x. One projection leaves a part along x if v is nearly parallel to it; after the others, little is
// left where nothing but rounding errors was.
fn direction_beside(x: vec3f, v: vec3f) -> vec3f {
  var y = v - dot(v, x) * x;
  var is_any = dot(y, y) < kNoSquare;
  for (var k = 0u; k < 2u && !is_any; k += 1u) {
    y = unit(y);
    y = y - dot(y, x) * x;
    is_any = dot(y, y) < 0.25;
  }
  if (is_any) {
    let size = abs(x);
    var axis = vec3f(0.0, 0.0, 1.0);
    if (size.x <= size.y && size.x <= size.z) {
      axis = vec3f(1.0, 0.0, 0.0);
    } else if (size.y <= size.z) {
      axis = vec3f(0.0, 1.0, 0.0);
    }
    y = axis - dot(axis, x) * x;
    y = y - dot(y, x) * x;
  }
  return unit(y);
}

fn frame_of(corner: array<vec3f, 3>, number: u32) -> Face {
  var corners = corner;
  var first = 0u;
  var squared = -1.0;
  for (var k = 0u; k < 3u; k += 1u) {
    let along = corners[(k + 1u) % 3u] - corners[k];
    if (dot(along, along) > squared) {
      squared = dot(along, along);
      first = k;
    }
  }
  let a = corners[first];
  let ab = corners[(first + 1u) % 3u] - a;
  let c = corners[(first + 2u) % 3u] - a;
  var x = vec3f(1.0, 0.0, 0.0);
  var length = 0.0;
  if (squared >= kNoSquare) {
    x = unit(ab);
    length = dot(ab, x);
  }
  let y = direction_beside(x, c);
  let z = unit(cross(x, y));
  let in_plane = vec2f(dot(c, x), dot(c, y));
  let ac = side(in_plane);
  return Face(vec4f(a, length), vec4f(x, ac.x), vec4f(y, ac.y), vec4f(z, ac.z), side(in_plane - vec2f(length, 0.0)),
              (number & ~3u) | first);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
        @builtin(local_invocation_index) lane: u32) {
  if (lane == 0u) {
    atomicStore(&longest, 0u);
  }
  workgroupBarrier();
  for (var i = id.x; i < part.count; i += 64u * groups.x) {
    let corners = face_sites[i].vertices;
    let face = frame_of(array<vec3f, 3>(vertex(corners[0]), vertex(corners[1]), vertex(corners[2])), refitted_faces[i].number);
    atomicMax(&longest, bitcast<u32>(face.origin_length.w));
    refitted_faces[i] = face;
  }
  workgroupBarrier();
  if (lane == 0u) {
    atomicMax(&refitted_errors[1], bitcast<u32>(kByLongest * bitcast<f32>(atomicLoad(&longest))));
  }
}
