#include "bodies/pairs/collision.h"

#include <algorithm>

#include "inside/solid.h"

namespace sdm::pairs {
namespace {

bool contains_part(const sites::SitesData& solid, const Affine& pose, const sites::SitesData& other,
                   const Affine& other_pose) {
  if (!solid.is_solid()) return false;
  return std::ranges::any_of(other.orientation.first_face, [&](std::uint32_t face) {
    return inside::contains(solid, pose, other_pose(other.mesh.positions[other.mesh.triangles[face][0]]));
  });
}

}  // namespace

bool one_contains_part_of_other(const pairs::MeshPair& pair) {
  const Affine in_place;
  return contains_part(pair.o1, in_place, pair.o2, pair.pose) ||
         contains_part(pair.o2, pair.pose, pair.o1, in_place);
}

}  // namespace sdm::pairs
