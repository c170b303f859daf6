#include "rays/unit_ray.h"

#include <algorithm>
#include <cmath>

namespace sdm::rays {
namespace {

// O2 lies in the cube [−1, 1]³, in the ball of radius 1.74 about 0. Rays from points beyond kFar start where
// they may reach the ball of radius kNear; those that meet O2 do so within kReach.
constexpr double kFar = 4, kNear = 2, kReach = 8;
// Several units in the last place of floats up to kFar; and more than the error of a hit.
constexpr double kError = 0x1p-20, kRelativeError = 0x1p-36;
constexpr double kSmallest = 0x1p-40;  // component of a direction: along 8 units, others are within the error

constexpr double kRoundedUp = 1 + 0x1p-22;

}  // namespace

bool UnitRay::place(const Ray& ray, const UnitFrame& frame) {
  if (!(ray.t_min <= ray.t_max)) return false;
  const Vec3& d = ray.direction;
  const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
  const Vec3 scaled{d[0] / largest, d[1] / largest, d[2] / largest};
  const double size = norm(scaled);
  const Vec3 unit = (1 / size) * scaled;
  const Vec3 from = frame.to_unit(ray.origin);
  const double away = norm(from);
  const double slack = kError + kRelativeError * away;
  length = frame.scale * largest * size;
  skipped = away > kFar ? away - kNear : 0;
  const Vec3 start = from + skipped * unit;
  // A direction that meets the ball of radius 1.74 comes within 3 of 0, r − 2 ahead of a point at distance
  // r ≥ 4.
  if (norm(start) > kFar + slack) return false;
  const double first = length * ray.t_min - skipped - slack, last = length * ray.t_max - skipped + slack;
  if (last < 0 || first > kReach + slack) return false;

  error = static_cast<float>(kRoundedUp * slack);
  begin = static_cast<float>(std::max(first, 0.0) / kRoundedUp);
  end = static_cast<float>(kRoundedUp * std::min(last, kReach + slack));
  for (int k = 0; k < 3; ++k) {
    origin[k] = static_cast<float>(start[k]);
    direction[k] = static_cast<float>(unit[k]);
    beyond_lo[k] = static_cast<float>(start[k] + slack);
    before_hi[k] = static_cast<float>(start[k] - slack);
    inverse[k] = static_cast<float>(1 / std::copysign(std::max(std::abs(unit[k]), kSmallest), unit[k]));
  }
  return true;
}

void UnitRay::end_at(double t) {
  end = std::min(end, static_cast<float>(kRoundedUp * (std::max(length * t - skipped, 0.0) + 2.0 * error)));
}

}  // namespace sdm::rays
