// The ball around the 64 points of each tile and those around its quarters, and a face that is closest to the middle: an
// invocation for each tile. Behind shaders/nearest_first.wgsl and shaders/part.wgsl.

@group(0) @binding(6) var<storage, read_write> tiles: array<Tile>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let t = id.x;
  if (t >= part.tiles) {
    return;
  }
  // The middles of boxes; points that are skipped count nowhere.
  let far = vec3f(kHuge);
  var lo = far;
  var hi = -far;
  var within = -1.0;
  var middles: array<vec3f, 4>;
  for (var q = 0u; q < 4u; q += 1u) {
    var part_lo = far;
    var part_hi = -far;
    for (var i = 0u; i < kQuarter; i += 1u) {
      let point = points[kTile * t + kQuarter * q + i];
      if (point.w >= 0.0) {
        part_lo = min(part_lo, point.xyz);
        part_hi = max(part_hi, point.xyz);
        within = max(within, point.w);
      }
    }
    middles[q] = 0.5 * (part_lo + part_hi);
    lo = min(lo, part_lo);
    hi = max(hi, part_hi);
  }
  if (within < 0.0) {
    tiles[t].all = Points(vec3f(), 0.0, kUnused, 0.0, within, 0u);
    return;
  }
  let centre = 0.5 * (lo + hi);
  var square = 0.0;
  for (var q = 0u; q < 4u; q += 1u) {
    var part_square = 0.0;
    for (var i = 0u; i < kQuarter; i += 1u) {
      let point = points[kTile * t + kQuarter * q + i];
      if (point.w >= 0.0) {
        square = max(square, dot(point.xyz - centre, point.xyz - centre));
        part_square = max(part_square, dot(point.xyz - middles[q], point.xyz - middles[q]));
      }
    }
    tiles[t].quarters[q] = vec4f(middles[q], sqrt(part_square) * kFarther);
  }
  let radius = sqrt(square) * kFarther;
  let outermost = max(abs(lo), abs(hi));
  let error = 3.0 * error_at(max(max(outermost.x, outermost.y), outermost.z));

  let reach = farther(within + radius, error);
  search_tree(centre, reach * reach, 0.0);
  tiles[t].all = Points(centre, radius, nearest_face, error, within, (visited << 16u) | min(tested, 0xffffu));
}
