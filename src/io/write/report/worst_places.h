// Where a surface is farthest from the other mesh.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

struct Place {
  double distance = 0;
  Vec3 point{};
  std::uint32_t texel = kNone;  ///< kNone at a vertex of the mesh
};

/// Places of large |distance| of texels and vertices of faces: first that of the largest one of all, then the
/// largest of other neighbourhoods, each at least 6 % of the mesh's diagonal from those before it; at most
/// ten. `vertex_distances`: one for each vertex of the mesh, not finite where there is none. Cost: linear,
/// all cores.
[[nodiscard]] std::vector<Place> worst_places(const Surface& surface, const DistanceMap& map,
                                              std::span<const float> vertex_distances);

}  // namespace sdm::io
