// The search of the tree for one point, nearest box first, with a stack for each invocation. Behind shaders/faces.wgsl.

const kStack = 128u;

// What the search has found: the faces within the limit that follows from the closest of them.
var<private> list: array<u32, kMost>;
var<private> squared: array<f32, kMost>;
var<private> count: u32;
var<private> limit: f32;     // squared
var<private> left_out: f32;  // the least squared distance of the faces that had no room in the list
var<private> nearest: f32;   // the least of all
var<private> nearest_face: u32;
var<private> overflow: bool;
var<private> visited: u32;
var<private> tested: u32;

fn compare(face: u32, p: vec3f, error: f32) {
  let distance = squared_to_face(faces[face], p);
  if (distance > limit) {
    return;
  }
  if (distance < nearest) {
    nearest = distance;
    nearest_face = face;
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
    list[count] = face;
    squared[count] = distance;
    count += 1u;
  } else {
    left_out = min(left_out, distance);
  }
}

// The faces within the square `first`, and within the limit.
fn search_tree(p: vec3f, first: f32, error: f32) {
  limit = first;
  count = 0u;
  left_out = kHuge;
  nearest = kHuge;
  nearest_face = kUnused;
  overflow = false;
  visited = 0u;
  tested = 0u;
  var stack_child: array<u32, kStack>;
  var stack_bound: array<f32, kStack>;
  var open = 1u;  // on the stack: the root
  while (open > 0u) {
    open -= 1u;
    if (stack_bound[open] > limit) {
      continue;
    }
    let child = stack_child[open];
    if ((child & kLeaf) != 0u) {
      let leaf = child & ~kLeaf;
      let end = leaves[leaf + 1u];
      for (var f = leaves[leaf]; f < end; f += 1u) {
        tested += 1u;
        compare(f, p, error);
      }
      continue;
    }
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
  }
}

// Sets `nearest` and `nearest_face`: of the list that is stored for a point, or of all faces where it is incomplete.
fn search_listed(i: u32) {
  let p = points[i].xyz;
  let head = results[i * kResult];
  var least = kHuge;
  var number = kUnused;
  for (var k = 1u; k <= (head & 15u); k += 1u) {
    let face = results[i * kResult + k];
    let square = squared_to_face(faces[face], p);
    if (square < least) {
      least = square;
      number = face;
    }
  }
  if ((head & kIncomplete) != 0u) {
    search_tree(p, least, 0.0);
    if (nearest < least) {
      return;
    }
  }
  nearest = least;
  nearest_face = number;
}
