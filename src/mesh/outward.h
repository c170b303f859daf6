// Which side of a closed mesh is out.
#pragma once

#include <sdm/types.h>

#include <span>
#include <vector>

#include "hierarchy/aabb_tree.h"
#include "mesh/topology.h"

namespace sdm {

/// For a closed, orientable mesh: which faces run clockwise seen from outside. A shell (a component of
/// `orientation`) bounds solid where it lies inside an even number of the others, and hollow where inside an
/// odd number: a point is inside when a ray from it meets the mesh an odd number of times. Shells that touch
/// or overlap each other bound solid. `tree` holds the faces, in the unit frame. Cost: linear, all cores, and
/// a few rays for each shell.
[[nodiscard]] std::vector<std::uint8_t> find_inverted(std::span<const Vec3> positions, const UnitFrame& frame,
                                                      std::span<const Triangle> triangles,
                                                      const Orientation& orientation, const AabbTree& tree);

}  // namespace sdm
