#include "certify/depth/boundary_part.h"

#include "certify/depth/face_distances.h"
#include "geometry/vec.h"

namespace sdm::depth {

std::array<CornerValues, 2> corner_distances(const sites::SitesData& solid, const Corners& at,
                                             const std::array<BoundaryPart, 2>& boundary) {
  std::array<std::uint32_t, 2> faces{boundary[0].face, boundary[1].face};
  std::array<CornerValues, 2> result;
  if (faces[0] != kNone || faces[1] != kNone) {
    for (int n = 0; n < 2; ++n)
      if (faces[n] == kNone) faces[n] = faces[1 - n];
    const auto found = face_distances(solid, {at[0], at[1], at[2], at[0]}, faces);
    for (int n = 0; n < 2; ++n) result[n] = {found[n][0], found[n][1], found[n][2]};
  }
  for (int n = 0; n < 2; ++n)
    if (boundary[n].face == kNone)
      for (int k = 0; k < 3; ++k) result[n][k] = norm(at[k] - boundary[n].point) - boundary[n].clear;
  return result;
}

}  // namespace sdm::depth
