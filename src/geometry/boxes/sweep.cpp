#include "geometry/boxes/sweep.h"

#include <algorithm>
#include <numeric>

#include "geometry/vec.h"

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

std::span<const Sweep::Pair> Sweep::near_pairs(std::span<const Box> boxes, double reach,
                                               const Filter& filter) {
  pairs_.clear();
  if (boxes.empty()) return pairs_;
  const int axis = sort(boxes);
  const double surely_far = reach / (kRoundedDown * kRoundedDown);
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const Box box = sorted_[i];
    for (std::size_t j = i + 1; j < sorted_.size(); ++j) {
      const Box& other = sorted_[j];
      if (kRoundedDown * (other.lo[axis] - box.hi[axis]) > reach) break;
      // Most are too far apart along one of the other axes. Without branches:
      bool far = false;
      for (int k = 0; k < 3; ++k)
        far |= (other.lo[k] - box.hi[k] > surely_far) | (box.lo[k] - other.hi[k] > surely_far);
      if (!far && box_distance(box, other) <= reach && (!filter || filter(order_[i], order_[j])))
        pairs_.push_back({std::min(order_[i], order_[j]), std::max(order_[i], order_[j])});
    }
  }
  std::ranges::sort(pairs_);
  return pairs_;
}

}  // namespace sdm::core
