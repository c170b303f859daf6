#include "certify/depth/boundary_part.h"

#include "certify/depth/face_distances.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"
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

bool heights_below_plane(const sites::SitesData& solid, const Corners& at, const BoundaryPart& boundary,
                         CornerValues& heights) {
  constexpr double kThinnest = 1e4;      // its error is 1e-10 of a distance
  constexpr double kLeastArea = 1e-150;  // squares of others underflow
  if (boundary.face == kNone || boundary.clear > 0) return false;
  const auto [a, b, c] = corners_of(solid.mesh, boundary.face);
  const Vec3 u = b - a, v = c - a, across = cross(u, v);
  const double area = norm(across);
  const double ratio = std::max({squared_norm(u), squared_norm(v), squared_norm(v - u)}) / area;
  if (!(ratio < kThinnest && area > kLeastArea)) return false;
  const Vec3 inward = (solid.inverted[boundary.face] != 0 ? 1 : -1) / area * across;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 x = at[k] - a;
    heights[k] = dot(inward, x) + kProductRounding * ratio * norm(x);
  }
  return true;
}

}  // namespace sdm::depth
