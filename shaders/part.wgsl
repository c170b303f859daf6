// The part of a map that a run computes.

struct Part {
  tiles: u32,
  first: u32,          // the place of the first sample in the buffers of the map
  count: u32,          // of the samples
  has_distances: u32,  // from other faces, if not 0
}

@group(0) @binding(7) var<uniform> part: Part;
