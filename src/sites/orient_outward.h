// The outward orientation of closed meshes.
#pragma once

#include <vector>

#include "inside/crossings/ray_parity.h"
#include "mesh/topology.h"

namespace sdm::sites {

/// The faces of each component of an orientation.
using Shells = CompressedRows<std::uint32_t>;
[[nodiscard]] Shells find_shells(const mesh::Orientation& orientation);

/// For a closed, orientable mesh: sets `inverted` for the faces that run clockwise seen from outside. A shell
/// bounds a solid if it lies inside an even number of the others, and a cavity if inside an odd number: a
/// point is inside when a ray from it meets the mesh an odd number of times. Shells that touch or overlap
/// each other bound solids. Cost: linear, all cores, plus a few rays per shell if there are several.
void orient_outward(const inside::FaceTree& faces, const mesh::Orientation& orientation, const Shells& shells,
                    std::vector<std::uint8_t>& inverted);

}  // namespace sdm::sites
