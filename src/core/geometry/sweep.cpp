#include "core/geometry/sweep.h"

#include <algorithm>
#include <numeric>

#include "core/geometry/vec.h"

namespace sdm::core {
namespace {

// The axis along which the centres of the boxes have the largest variance.
int widest_axis(std::span<const Box> boxes) {
  const double share = 1 / static_cast<double>(boxes.size());
  Vec3 mean{}, variance{};
  for (const Box& box : boxes) mean += share * centre(box);
  for (const Box& box : boxes)
    for (int k = 0; k < 3; ++k) {
      const double off = centre(box)[k] - mean[k];
      variance[k] += share * off * off;
    }
  return static_cast<int>(std::ranges::max_element(variance) - variance.begin());
}

}  // namespace

double box_distance(const Box& a, const Box& b) {
  return Sweep::kRoundedDown * norm(gap(a, b));
}

int Sweep::sort(std::span<const Box> boxes) {
  const int axis = widest_axis(boxes);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [&](std::uint32_t b) { return std::pair(boxes[b].lo[axis], b); });
  sorted_.clear();
  for (const std::uint32_t b : order_) sorted_.push_back(boxes[b]);
  return axis;
}

std::span<const Sweep::Pair> Sweep::near_pairs(std::span<const Box> boxes, double reach) {
  pairs_.clear();
  for_each_near(boxes, reach, [&](std::uint32_t a, std::uint32_t b) {
    pairs_.push_back({std::min(a, b), std::max(a, b)});
  });
  std::ranges::sort(pairs_);
  return pairs_;
}

}  // namespace sdm::core
