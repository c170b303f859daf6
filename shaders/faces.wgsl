// What the searches share: the tree and the faces of O2, distances from them, and lists of faces for points.

// A child of a node: eight for each. A number with the highest bit is that of a leaf.
struct ChildBox {
  lo: vec3f,
  number: u32,
  hi: vec3f,
  padding: u32,
}

// A triangle in the frame of its longest side AB (sites/face_frames.h).
struct Face {
  origin_length: vec4f,  // A; |AB|
  along_ac: vec4f,       // the direction of AB; that of AC along AB
  beside_ac: vec4f,      // the direction beside AB in the plane; that of AC beside AB
  normal_ac: vec4f,      // the normal; |AC|
  bc: vec3f,             // the direction of BC along and beside AB; |BC|
  number: u32,           // of the face, times 4; and which of its corners A is
}

struct Errors {
  by_coordinate: f32,  // of each unit of the largest coordinate of a point
  constant: f32,
  padding: vec2f,
}

// 64 points that are neighbours.
struct Tile {
  all: Points,
  quarters: array<vec4f, 4>,  // the middle and the radius of a ball around each quarter of them
}
struct Points {
  centre: vec3f,  // of a ball around them
  radius: f32,
  face: u32,      // that is near the middle; kUnused if no point has a face
  error: f32,     // three times error_at() of the points
  within: f32,    // no face farther from a point is closest
  counts: u32,    // of nodes and of faces, that the search for the middle visited
}

@group(0) @binding(0) var<uniform> errors: Errors;
@group(0) @binding(1) var<storage, read> boxes: array<ChildBox>;
@group(0) @binding(2) var<storage, read> leaves: array<u32>;  // the first face of each leaf, and an end
@group(0) @binding(3) var<storage, read> faces: array<Face>;
@group(0) @binding(4) var<storage, read> points: array<vec4f>;  // and the largest distance; negative: skip the point
@group(0) @binding(5) var<storage, read_write> results: array<u32>;

const kLeaf = 0x80000000u;
const kUnused = 0xffffffffu;
const kTile = 64u;
const kQuarter = 16u;
const kMost = 15u;     // faces in a list
const kResult = 16u;   // numbers of a point: the head, then its list
const kIncomplete = 16u;
const kAlone = 32u;    // the points of the tile are searched for one by one
const kFarther = 1.000008;
const kHuge = 3e38;  // more than any square

// Twice the error of a distance, but for a part in proportion to it.
fn error_at(largest_coordinate: f32) -> f32 {
  return errors.by_coordinate * max(largest_coordinate, 1.0) + errors.constant;
}
fn farther(distance: f32, error: f32) -> f32 {
  return distance * kFarther + error;
}

fn squared_to_box(box: ChildBox, p: vec3f) -> f32 {
  let r = p - clamp(p, box.lo, box.hi);
  return dot(r, r);
}

fn minus_clamped(t: f32, end: f32) -> f32 {
  return t - clamp(t, 0.0, end);
}

// As squared_to_faces() of closest/face_distances-inl.h.
fn squared_to_face(face: Face, p: vec3f) -> f32 {
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

// The point of a face that is closest to a point of its plane, or one that is nearly as close, and the site it lies on: 0 to 2,
// the corners A, B and C; 3 to 5, the sides AB, BC and CA; 6, the face.
struct InPlane {
  at: vec2f,  // along and beside AB
  site: u32,
}
fn on_side(q: vec2f, start: vec2f, along: vec2f, length: f32, sites: vec3u) -> InPlane {
  let t = clamp(dot(q - start, along), 0.0, length);
  return InPlane(start + t * along, select(select(sites.z, sites.y, t >= length), sites.x, t <= 0.0));
}
fn nearer(a: InPlane, b: InPlane, q: vec2f) -> InPlane {
  if (dot(q - b.at, q - b.at) < dot(q - a.at, q - a.at)) {
    return b;
  }
  return a;
}
fn closest_in_plane(face: Face, q: vec2f) -> InPlane {
  let length = face.origin_length.w;
  let ac = vec2f(face.along_ac.w, face.beside_ac.w);
  let bc = face.bc.xy;
  if (q.y > 0.0 && q.y * ac.x - q.x * ac.y < 0.0 && q.y * bc.x - (q.x - length) * bc.y > 0.0) {
    return InPlane(q, 6u);
  }
  let on_ab = on_side(q, vec2f(), vec2f(1.0, 0.0), length, vec3u(0u, 1u, 3u));
  let on_ac = on_side(q, vec2f(), ac, face.normal_ac.w, vec3u(0u, 2u, 5u));
  let on_bc = on_side(q, vec2f(length, 0.0), bc, face.bc.z, vec3u(1u, 2u, 4u));
  return nearer(nearer(on_ab, on_ac, q), on_bc, q);
}
fn closest_of_face(face: Face, p: vec3f) -> vec3f {
  let r = p - face.origin_length.xyz;
  let closest = closest_in_plane(face, vec2f(dot(r, face.along_ac.xyz), dot(r, face.beside_ac.xyz))).at;
  return face.origin_length.xyz + closest.x * face.along_ac.xyz + closest.y * face.beside_ac.xyz;
}

// The distance from a point to the farthest corner of a face.
fn farthest_of_face(face: Face, p: vec3f) -> f32 {
  let a = face.origin_length.xyz - p;
  let b = a + face.origin_length.w * face.along_ac.xyz;
  let c = a + face.normal_ac.w * (face.along_ac.w * face.along_ac.xyz + face.beside_ac.w * face.beside_ac.xyz);
  return sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
}

// The first number of a result.
fn head_of(count: u32, incomplete: bool, visited: u32, tested: u32) -> u32 {
  return count | select(0u, kIncomplete, incomplete) | (min(visited, 0xfffu) << 6u) | (min(tested, 0x3fffu) << 18u);
}
