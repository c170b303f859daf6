#include "inside/winding_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/vec.h"
#include "inside/solid.h"

namespace sdm::inside {
namespace {

double way_out(const Box& box, const Vec3& point) {
  double way = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) way = std::min({way, point[k] - box.lo[k], box.hi[k] - point[k]});
  return std::max(way, 0.0);
}

}  // namespace

void WindingWalk::start(std::uint64_t shape) {
  if (shape == shape_) return;
  shape_ = shape, near_ = false, overlapping_ = 1;
  clear_.fill(-std::numeric_limits<double>::infinity());
}

void WindingWalk::keep(const Vec3& point, double clear, int number) {
  next_ = (next_ + 1) % kKept;
  for (int k = 0; k < 3; ++k) at_[static_cast<std::size_t>(k)][next_] = point[k];
  clear_[next_] = clear, number_[next_] = number;
}

void WindingWalk::approach(const ShapeSigns& signs, const sites::SitesData& solid,
                           std::span<const Vec3> points) {
  start(signs.number);
  near_ = false;  // also if this fails
  near_box_ = {};
  for (const Vec3& p : points) extend(near_box_, p);
  // The point before is mostly near, too.
  if (std::isfinite(clear_[next_])) extend(near_box_, Vec3{at_[0][next_], at_[1][next_], at_[2][next_]});
  // More than the rounding of segments.
  const Vec3 margin{1e-5, 1e-5, 1e-5};
  rays::find_near_nodes(solid,
                        tree::FloatBox::around({solid.frame.to_unit(near_box_.lo) - margin,
                                                solid.frame.to_unit(near_box_.hi) + margin}),
                        near_nodes_);
  near_ = true;
}

std::optional<int> WindingWalk::winding(const ShapeSigns& signs, const sites::SitesData& solid,
                                        const Vec3& point, double clear, bool by_balls) {
  constexpr double kMostly = 0.4, kNew = 0.05;
  start(signs.number);
  std::array<double, kKept> gap;
  for (std::size_t i = 0; i < kKept; ++i) {
    const double x = at_[0][i] - point[0], y = at_[1][i] - point[1], z = at_[2][i] - point[2];
    gap[i] = std::sqrt(x * x + y * y + z * z) - clear_[i];
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(gap) - gap.begin());
  const bool overlap = gap[best] < clear;
  overlapping_ += kNew * ((overlap ? 1 : 0) - overlapping_);
  if (by_balls && !overlap && overlapping_ < kMostly) return {};
  std::optional<int> number;
  if (overlap) {
    number = number_[best];
  } else if (gap[best] - clear < way_out(signs.box, point)) {
    const Vec3 from{at_[0][best], at_[1][best], at_[2][best]};
    const double length = norm(from - point);
    const bool near = near_ && sdm::contains(near_box_, from) && sdm::contains(near_box_, point);
    // Only the part between the two balls can meet faces.
    const auto turns = crossings(solid, {point, from, clear / length, 1 - clear_[best] / length},
                                 near ? &near_nodes_ : nullptr);
    if (turns) number = number_[best] + *turns;
  }
  const int found = number ? *number : inside::winding(solid, point);
  keep(point, clear, found);
  return found;
}

}  // namespace sdm::inside
