/// The convex hull of a mesh, as a mesh.
///
/// Threads: the function may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

namespace sdm {

/// The convex hull of the corners of all faces: a closed mesh of triangles, counter-clockwise from outside.
/// Its vertices are corners at their positions, to the bit, in their order; no corner is outside, and no edge
/// reflex, which is decided exactly. Shape::convex() of it is true, unless it has more vertices than that
/// looks at, or is as thin as rounding. Faces in one plane are divided into
/// triangles; corners inside of faces and edges of the hull are left out, as a rule.
///
/// Throws sdm::Error for a mesh that is not valid, for one whose corners are in one plane, and if there is
/// not enough memory. Cost: O(n log n) as a rule, single-threaded.
[[nodiscard]] SDM_API Mesh convex_hull(const Mesh& mesh);

}  // namespace sdm
