#include "core/sweep.h"

#include <algorithm>
#include <numeric>

#include "core/vec.h"

namespace sdm::core {
namespace {

constexpr double kRoundedDown = 1 - 1e-15;  // by more than differences, squares, their sum and its root round

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
  Vec3 gap;
  for (int k = 0; k < 3; ++k) gap[k] = std::max({a.lo[k] - b.hi[k], b.lo[k] - a.hi[k], 0.0});
  return kRoundedDown * norm(gap);
}

std::span<const Sweep::Pair> Sweep::near_pairs(std::span<const Box> boxes, double reach) {
  pairs_.clear();
  open_.clear();
  if (boxes.empty()) return pairs_;
  const int axis = widest_axis(boxes);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [&](std::uint32_t b) { return std::pair(boxes[b].lo[axis], b); });
  for (const std::uint32_t b : order_) {
    // Later boxes begin farther along the axis, so boxes that end before this one are removed.
    std::erase_if(open_, [&](std::uint32_t o) {
      return kRoundedDown * (boxes[b].lo[axis] - boxes[o].hi[axis]) > reach;
    });
    for (const std::uint32_t o : open_)
      if (box_distance(boxes[o], boxes[b]) <= reach) pairs_.push_back({std::min(o, b), std::max(o, b)});
    open_.push_back(b);
  }
  std::ranges::sort(pairs_);
  return pairs_;
}

}  // namespace sdm::core
