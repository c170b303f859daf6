#include "geometry/boxes.h"

#include <algorithm>
#include <numeric>
#include <utility>

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
  std::ranges::sort(order_, {}, [&](std::uint32_t b) { return std::pair(boxes[b].lower[axis], b); });
  sorted_.clear();
  for (const std::uint32_t b : order_) sorted_.push_back(boxes[b]);
  return axis;
}

std::span<const Sweep::Pair> Sweep::near_pairs(std::span<const Box> boxes, double max_distance,
                                               const Filter& filter) {
  pairs_.clear();
  if (boxes.empty()) return pairs_;
  const int axis = sort(boxes);
  const double surely_far = max_distance / (kRoundedDown * kRoundedDown);
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const Box box = sorted_[i];
    for (std::size_t j = i + 1; j < sorted_.size(); ++j) {
      const Box& other = sorted_[j];
      if (kRoundedDown * (other.lower[axis] - box.upper[axis]) > max_distance) break;
      // Most are too far apart along one of the other axes. Without branches:
      bool far = false;
      for (int k = 0; k < 3; ++k)
        far |= (other.lower[k] - box.upper[k] > surely_far) | (box.lower[k] - other.upper[k] > surely_far);
      if (!far && box_distance(box, other) <= max_distance && (!filter || filter(order_[i], order_[j])))
        pairs_.push_back({std::min(order_[i], order_[j]), std::max(order_[i], order_[j])});
    }
  }
  std::ranges::sort(pairs_);
  return pairs_;
}

namespace {

constexpr std::uint32_t kLeafBoxes = 4;

}  // namespace

void BoxGroups::find(std::span<const Box> boxes, DisjointSets& groups) {
  groups.reset(boxes.size());
  if (boxes.empty()) return;
  boxes_ = boxes;
  groups_ = &groups;
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.clear();
  unite_within(build(0, static_cast<std::uint32_t>(boxes.size())));
}

std::uint32_t BoxGroups::build(std::uint32_t begin, std::uint32_t end) {
  Box box;
  for (std::uint32_t i = begin; i < end; ++i) extend(box, boxes_[order_[i]]);
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box, begin, end, kNone, kNone, false});
  if (end - begin <= kLeafBoxes) return node;
  const Vec3 size = box.upper - box.lower;
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto twice_centre = [&](std::uint32_t i) {
    return std::pair(boxes_[i].lower[axis] + boxes_[i].upper[axis], i);
  };
  std::ranges::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, {},
                           twice_centre);
  const std::uint32_t left = build(begin, middle), right = build(middle, end);
  nodes_[node].left = left;
  nodes_[node].right = right;
  return node;
}

void BoxGroups::unite_within(std::uint32_t node) {
  const Node& n = nodes_[node];
  if (n.left == kNone) {
    for (std::uint32_t i = n.begin; i < n.end; ++i)
      for (std::uint32_t j = i + 1; j < n.end; ++j) unite_if_meeting(order_[i], order_[j]);
  } else {
    unite_within(n.left);
    unite_within(n.right);
    unite_between(n.left, n.right);
  }
  update(nodes_[node]);
}

void BoxGroups::unite_between(std::uint32_t a, std::uint32_t b) {
  Node &of_a = nodes_[a], &of_b = nodes_[b];
  if (!overlap(of_a.box, of_b.box)) return;
  if (of_a.one_group && of_b.one_group && group_of(of_a) == group_of(of_b)) return;
  if (of_a.left == kNone && of_b.left == kNone) {
    for (std::uint32_t i = of_a.begin; i < of_a.end; ++i)
      for (std::uint32_t j = of_b.begin; j < of_b.end; ++j) unite_if_meeting(order_[i], order_[j]);
  } else if (of_b.left == kNone || of_a.end - of_a.begin > of_b.end - of_b.begin) {
    unite_between(of_a.left, b);
    unite_between(of_a.right, b);
  } else {
    unite_between(a, of_b.left);
    unite_between(a, of_b.right);
  }
  update(of_a);
  update(of_b);
}

void BoxGroups::unite_if_meeting(std::uint32_t i, std::uint32_t j) {
  if (overlap(boxes_[i], boxes_[j])) groups_->unite(i, j);
}

// Boxes that are in one group stay in one.
void BoxGroups::update(Node& node) {
  if (node.one_group) return;
  const std::uint32_t group = group_of(node);
  if (node.left == kNone)
    node.one_group = std::all_of(order_.begin() + node.begin, order_.begin() + node.end,
                                 [&](std::uint32_t i) { return groups_->find(i) == group; });
  else
    node.one_group = nodes_[node.left].one_group && nodes_[node.right].one_group &&
                     group_of(nodes_[node.left]) == group_of(nodes_[node.right]);
}

}  // namespace sdm::core
