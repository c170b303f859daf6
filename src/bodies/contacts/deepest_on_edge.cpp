#include "bodies/contacts/deepest_on_edge.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "geometry/vec.h"

namespace sdm::contacts {
namespace {

constexpr std::size_t kMostMeasured = 8;
// A point is deep enough if no other is deeper by more than this factor.
constexpr double kNearlyDeepest = 1.25;
// What is greater by less does not count: rounding, which depends on the pose, would choose between equals.
constexpr double kGreater = 1 + 1e-6;

}  // namespace

double most_between(const EdgeInside& line) {
  return 0.5 * (line.from_depth + line.to_depth + norm(line.to - line.from));
}

SurfacePoint deep_point(const shape::Body& solid, const EdgeInside& line, double enough,
                        std::uint32_t near_face) {
  std::array<EdgeInside, kMostMeasured + 1> parts{line};
  SurfacePoint deepest{.distance = -enough};
  for (std::size_t count = 1; count <= kMostMeasured; ++count) {
    std::size_t highest = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (most_between(parts[i]) > kGreater * most_between(parts[highest])) highest = i;
    EdgeInside& part = parts[highest];
    if (most_between(part) <= std::max(enough, kNearlyDeepest * -deepest.distance)) break;
    const Vec3 along = part.to - part.from;
    const double length = norm(along);
    const double t = std::clamp(0.5 + 0.5 * (part.to_depth - part.from_depth) / length, 0.0, 1.0);
    const SurfacePoint point = measure_near(solid, part.from + t * along, near_face);
    near_face = point.face;
    if (point.distance < kGreater * deepest.distance) deepest = point;
    parts[count] = {point.at, part.to, -point.distance, part.to_depth};
    part.to = point.at;
    part.to_depth = -point.distance;
  }
  return deepest;
}

}  // namespace sdm::contacts
