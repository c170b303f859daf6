// What 1024 distances of a map are summed up to, by a workgroup.

struct Limits {
  count: u32,
  within: f32,  // up to this, a distance is certainly within the tolerance
  beyond: f32,  // above this, certainly beyond
  padding: u32,
}
struct Sums {
  smallest: f32,
  largest: f32,
  sum: f32,
  squares: f32,
  largest_at: u32,  // the first of them
  within: u32,
  beyond: u32,
  padding: u32,
}

@group(0) @binding(0) var<uniform> limits: Limits;
@group(0) @binding(1) var<storage, read> distances: array<f32>;
@group(0) @binding(2) var<storage, read_write> results: array<Sums>;

const kLanes = 256u;
const kEach = 4u;

var<workgroup> of_lanes: array<Sums, kLanes>;

fn both(a: Sums, b: Sums) -> Sums {
  let from_b = b.largest > a.largest || (b.largest == a.largest && b.largest_at < a.largest_at);
  return Sums(min(a.smallest, b.smallest), max(a.largest, b.largest), a.sum + b.sum, a.squares + b.squares,
              select(a.largest_at, b.largest_at, from_b), a.within + b.within, a.beyond + b.beyond, 0u);
}

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  var own = Sums(3e38, -1.0, 0.0, 0.0, 0xffffffffu, 0u, 0u, 0u);
  for (var k = 0u; k < kEach; k += 1u) {
    let i = (group.x * kEach + k) * kLanes + lane;
    if (i < limits.count) {
      let d = distances[i];
      own = both(own, Sums(d, d, d, d * d, i, select(0u, 1u, d <= limits.within), select(0u, 1u, d > limits.beyond), 0u));
    }
  }
  of_lanes[lane] = own;
  for (var half = kLanes / 2u; half > 0u; half /= 2u) {
    workgroupBarrier();
    if (lane < half) {
      of_lanes[lane] = both(of_lanes[lane], of_lanes[lane + half]);
    }
  }
  if (lane == 0u) {
    results[group.x] = of_lanes[0];
  }
}
