#include "proximity/exact/collision.h"

#include <algorithm>

namespace sdm::exact {
namespace {

bool contains_part(const sites::SitesData& solid, const Affine& pose, const sites::SitesData& other,
                   const Affine& other_pose, std::vector<std::uint32_t>& stack) {
  if (!solid.is_solid()) return false;
  return std::ranges::any_of(other.orientation.first_face, [&](std::uint32_t face) {
    return inside::contains(solid, pose, other_pose(other.mesh.positions[other.mesh.triangles[face][0]]),
                            stack);
  });
}

}  // namespace

bool one_contains_part_of_other(const exact::MeshPair& pair, exact::PairWorkspace& workspace) {
  const Affine in_place;
  return contains_part(pair.o1, in_place, pair.o2, pair.pose, workspace.nodes) ||
         contains_part(pair.o2, pair.pose, pair.o1, in_place, workspace.nodes);
}

}  // namespace sdm::exact
