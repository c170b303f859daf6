// The closest points of a map, which stay on the device: of each point that of the face that has the least distance of those in
// its list, or of all where the list is incomplete. Behind shaders/nearest_first.wgsl, shaders/part.wgsl and
// shaders/face_sites.wgsl; runs after shaders/closest_faces.wgsl.

struct Closest {
  x: f32,     // from the point to its closest point
  y: f32,
  z: f32,
  face: u32,
  kind: u32,  // of the site: a vertex, an edge or the face, as SiteType
  site: u32,
}

@group(0) @binding(6) var<storage, read_write> all_closest: array<Closest>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= part.count) {
    return;
  }
  search_listed(i);
  if (nearest_face == kUnused) {
    return;
  }
  let place = part.first + i;
  if (part.has_distances != 0u) {
    let before = vec3f(all_closest[place].x, all_closest[place].y, all_closest[place].z);
    if (dot(before, before) <= nearest) {
      return;
    }
  }
  let face = faces[nearest_face];
  let r = points[i].xyz - face.origin_length.xyz;
  let closest = closest_in_plane(face, vec2f(dot(r, face.along_ac.xyz), dot(r, face.beside_ac.xyz)));
  let v = closest.at.x * face.along_ac.xyz + closest.at.y * face.beside_ac.xyz - r;
  let of_mesh = face.number >> 2u;
  let corner = (closest.site + (face.number & 3u)) % 3u;
  var site = of_mesh;
  if (closest.site < 3u) {
    site = face_sites[nearest_face].vertices[corner];
  } else if (closest.site < 6u) {
    site = face_sites[nearest_face].edges[corner];
  }
  all_closest[place] = Closest(v.x, v.y, v.z, of_mesh, closest.site / 3u, site);
}
