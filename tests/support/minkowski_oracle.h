// The Minkowski difference of two solids by CGAL, exactly.
#pragma once

#include <sdm/mesh.h>

namespace sdm::oracle {

/// The distance from 0 to the boundary of the difference of two solids that overlap, the set of all
/// translations of `a` after which their interiors have a point in common: that is the length of the shortest
/// one that separates them. Meshes are closed, oriented outwards and without self-intersections. Cost:
/// minutes for thousands of faces.
[[nodiscard]] double separating_distance(const Mesh& a, const Mesh& b);

}  // namespace sdm::oracle
