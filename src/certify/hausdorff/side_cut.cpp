#include "certify/hausdorff/side_cut.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

namespace sdm::hausdorff {

std::optional<SideCut> cut_along_side(const Corners& triangle, const Corners& face, const Vec3& normal,
                                      double offset, double margin) {
  Vec3 beyond{};  // of the corners, over the line of the cut
  double farthest = margin;
  for (int k = 0; k < 3; ++k) {
    const Vec3 outward = normalized(cross(face[(k + 1) % 3] - face[k], normal));
    Vec3 distances;
    for (int i = 0; i < 3; ++i) distances[i] = dot(outward, triangle[i] - face[k]) - offset;
    const auto [least, most] = std::minmax({distances[0], distances[1], distances[2]});
    if (most > farthest && least < -margin) farthest = most, beyond = distances;
  }
  if (beyond == Vec3{}) return std::nullopt;
  const auto outside = std::ranges::count_if(beyond, [](double distance) { return distance > 0; });
  SideCut cut;
  for (int i = 0; i < 3; ++i)
    if ((beyond[i] > 0) == (outside == 1)) cut.alone = i;
  const double from = beyond[cut.alone];
  for (const int side : {0, 1}) cut.at[side] = from / (from - beyond[(cut.alone + 1 + side) % 3]);
  return cut;
}

double longest_side(const Corners& t) {
  return std::sqrt(
      std::max({squared_norm(t[1] - t[0]), squared_norm(t[2] - t[1]), squared_norm(t[0] - t[2])}));
}

}  // namespace sdm::hausdorff
