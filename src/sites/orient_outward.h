// The outward orientation of closed meshes.
#pragma once

#include "mesh/crossings/ray_parity.h"
#include "mesh/topology.h"

namespace sdm::sites {

/// The faces of each component of an orientation.
using Shells = CompressedRows<std::uint32_t>;
[[nodiscard]] Shells find_shells(const mesh::Orientation& orientation);

/// Sets `inverted` for the faces of a closed, orientable mesh that run clockwise seen from outside. A shell
/// bounds a solid if it lies inside an even number of other shells, and a cavity if inside an odd number;
/// shells that it touches or intersects do not count. Cost: linear, all cores, plus a ray for each shell and
/// the pairs of faces of different shells whose boxes overlap, if there are several.
void orient_outward(const inside::FaceTree& faces, const mesh::Orientation& orientation, const Shells& shells,
                    Array<std::uint8_t>& inverted);

}  // namespace sdm::sites
