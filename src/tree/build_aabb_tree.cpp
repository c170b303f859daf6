#include "tree/aabb_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tree/build_aabb_tree.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>

#include "core/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::tree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr uint32_t kParallelItems = 2048;  // smaller subtrees are built by one thread
// Below this level, nodes are divided into halves: whatever the boxes, no node is deeper than this and the
// logarithm of the number of items, which bounds the stack of recursions. Trees of meshes are far less deep.
constexpr int kLastCut = kDeepest - 32;

// A box as −lo and hi, so that a union is a maximum. The fourth lane of each is unused.
struct Bounds {
  alignas(32) float reach[2][4];

  static Bounds none() {
    constexpr float none = -std::numeric_limits<float>::infinity();
    return {{{none, none, none, none}, {none, none, none, none}}};
  }
  HWY_INLINE void extend(const Bounds& other) {
    const hn::CappedTag<float, 8> d;
    float* all = reach[0];
    for (size_t i = 0; i < 8; i += hn::Lanes(d))
      hn::Store(hn::Max(hn::Load(d, all + i), hn::Load(d, other.reach[0] + i)), d, all + i);
  }
  float extent(int axis) const { return reach[0][axis] + reach[1][axis]; }
  float half_area() const { return extent(0) * extent(1) + extent(1) * extent(2) + extent(2) * extent(0); }
};

// The box of an item, with its index in an unused lane.
Bounds item_of(const FloatBox& box, uint32_t index) {
  return {{{-box.lower[0], -box.lower[1], -box.lower[2], std::bit_cast<float>(index)},
           {box.upper[0], box.upper[1], box.upper[2], 0}}};
}
uint32_t index_of(const Bounds& item) {
  return std::bit_cast<uint32_t>(item.reach[0][3]);
}

// Divides the range of the items' centres along each axis into bins. Centres are stored multiplied by two.
struct Binning {
  static constexpr int kBins = 8;

  alignas(16) float first[4], per_length[4] = {};

  explicit Binning(const Bounds& centres) {
    constexpr float kLeastExtent = 1e-30f;  // keeps the quotient finite; below it, all are in the first bin
    for (int k = 0; k < 4; ++k) first[k] = -centres.reach[0][k];
    for (int k = 0; k < 3; ++k)
      if (centres.extent(k) > kLeastExtent) per_length[k] = kBins / centres.extent(k);
  }

  // The bin along each axis.
  HWY_INLINE void find(const Bounds& item, int32_t (&bin)[4]) const {
    const hn::CappedTag<float, 4> d;
    const hn::RebindToSigned<decltype(d)> di;
    for (size_t i = 0; i < 4; i += hn::Lanes(d)) {
      const auto centre = hn::Sub(hn::Load(d, item.reach[1] + i), hn::Load(d, item.reach[0] + i));
      const auto along = hn::Mul(hn::Sub(centre, hn::Load(d, first + i)), hn::Load(d, per_length + i));
      hn::Store(hn::ConvertTo(di, hn::Min(along, hn::Set(d, kBins - 1.0f))), di, bin + i);
    }
  }
  // Whether the bin along one axis is `bin` or a later one, for 0 < bin < kBins.
  HWY_INLINE bool from(int bin, const Bounds& item, int axis) const {
    const float centre = item.reach[1][axis] - item.reach[0][axis];
    return (centre - first[axis]) * per_length[axis] >= static_cast<float>(bin);
  }
};

class Builder {
 public:
  Builder(std::span<const FloatBox> boxes, std::vector<uint32_t>& indices, uint32_t leaf_size)
      : indices_(indices), leaf_size_(leaf_size), nodes_(2 * indices.size()) {
    for (auto& items : items_) items = std::make_unique_for_overwrite<Bounds[]>(indices.size());
    parallel_for(indices.size(), kParallelItems, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) items_[0][i] = item_of(boxes[indices[i]], indices[i]);
    });
  }

  std::vector<AabbTree::Node> build() {
    parallel_tasks([&](Tasks& tasks) { build(tasks, 0, 0, static_cast<uint32_t>(indices_.size()), 0); });
    std::vector<AabbTree::Node> compact;
    compact.reserve(count_nodes(0));
    copy(0, compact);
    return compact;
  }

 private:
  // Builds the subtree of the items from `begin` to `end` of items_[level % 2]. A subtree of n items has at
  // most 2n − 1 nodes: with that many slots reserved for each, threads need no synchronisation, and copy()
  // closes the gaps afterwards.
  void build(Tasks& tasks, uint32_t slot, uint32_t begin, uint32_t end, int level) {
    const Bounds* items = items_[level % 2].get();
    Bounds box, centres;
    bound(items + begin, items + end, box, centres);
    AabbTree::Node& node = nodes_[slot];
    for (int k = 0; k < 3; ++k) {
      node.box.lower[k] = -box.reach[0][k];
      node.box.upper[k] = box.reach[1][k];
    }
    if (end - begin <= leaf_size_) {
      node.first = begin;
      node.count = end - begin;
      for (uint32_t i = begin; i < end; ++i) indices_[i] = index_of(items[i]);
      return;
    }
    const uint32_t middle = split(begin, end, level, Binning(centres));
    const uint32_t left = slot + 1, right = slot + 2 * (middle - begin);
    node.right = right;
    const auto build_right = [=, this, &tasks] { build(tasks, right, middle, end, level + 1); };
    if (end - begin >= kParallelItems) tasks.add(build_right);
    build(tasks, left, begin, middle, level + 1);
    if (end - begin < kParallelItems) build_right();
  }

  static HWY_INLINE void bound(const Bounds* begin, const Bounds* end, Bounds& box, Bounds& centres) {
    const hn::CappedTag<float, 4> d;
    box = centres = Bounds::none();
    for (size_t k = 0; k < 4; k += hn::Lanes(d)) {
      auto lo = hn::Load(d, box.reach[0] + k), hi = lo, first = lo, last = lo;
      for (const Bounds* item = begin; item != end; ++item) {
        const auto against = hn::Load(d, item->reach[0] + k), along = hn::Load(d, item->reach[1] + k);
        lo = hn::Max(lo, against);
        hi = hn::Max(hi, along);
        first = hn::Max(first, hn::Sub(against, along));
        last = hn::Max(last, hn::Sub(along, against));
      }
      hn::Store(lo, d, box.reach[0] + k);
      hn::Store(hi, d, box.reach[1] + k);
      hn::Store(first, d, centres.reach[0] + k);
      hn::Store(last, d, centres.reach[1] + k);
    }
  }

  // Moves the items to the other array, those of the left side first; returns where the right side begins.
  // Not inlined: its arrays would be on the stack at every level of the recursion.
  HWY_NOINLINE uint32_t split(uint32_t begin, uint32_t end, int level, const Binning& binning) {
    const Bounds* items = items_[level % 2].get();
    const auto [axis, bin] = level < kLastCut ? best_cut(items + begin, end - begin, binning) : Cut{-1, 0};
    const uint32_t half = begin + (end - begin) / 2;
    // Branches would be mispredicted every other time. So each item is written to both ends of the gap
    // between the two sides, and the gap shrinks at the end where the item belongs.
    Bounds* moved = items_[1 - level % 2].get();
    uint32_t left = begin, right = end;
    for (uint32_t i = begin; i < end; ++i) {
      const bool to_right = axis < 0 ? i >= half : binning.from(bin, items[i], axis);
      moved[left] = moved[right - 1] = items[i];
      left += !to_right;
      right -= to_right;
    }
    return left;
  }

  struct Cut {
    int axis, bin;  ///< the first bin of the right side; axis −1 if the centres of all items agree
  };

  // The cut of lowest cost by the surface area heuristic: area × number of leaves, summed over both sides,
  // since a leaf is visited as a whole, full or not. For many items, a subset of them suffices.
  Cut best_cut(const Bounds* items, uint32_t item_count, const Binning& binning) const {
    constexpr int kBins = Binning::kBins;
    constexpr uint32_t kSample = 512;
    const uint32_t stride = std::max(1u, item_count / kSample);
    Bounds box[3][kBins];
    uint32_t count[3][kBins] = {}, total = 0;
    for (auto& axis : box) std::fill_n(axis, kBins, Bounds::none());
    for (uint32_t i = 0; i < item_count; i += stride, ++total) {
      alignas(16) int32_t bin[4];
      binning.find(items[i], bin);
      for (int axis = 0; axis < 3; ++axis) {
        box[axis][bin[axis]].extend(items[i]);
        ++count[axis][bin[axis]];
      }
    }
    const auto cost = [&](const Bounds& side, uint32_t side_count) {
      const uint32_t leaves = (stride * side_count + leaf_size_ - 1) / leaf_size_;
      return side.half_area() * static_cast<float>(leaves);
    };

    Cut best{-1, 0};
    float least = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      float left_cost[kBins];  // of all bins before each
      Bounds side = Bounds::none();
      uint32_t side_count = 0;
      for (int b = 1; b < kBins; ++b) {
        side.extend(box[axis][b - 1]);
        side_count += count[axis][b - 1];
        left_cost[b] = cost(side, side_count);
      }
      side = Bounds::none();
      side_count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        side.extend(box[axis][b]);
        side_count += count[axis][b];
        if (side_count == 0 || side_count == total) continue;
        if (const float sum = left_cost[b] + cost(side, side_count); sum < least) {
          least = sum;
          best = {axis, b};
        }
      }
    }
    return best;
  }

  size_t count_nodes(uint32_t slot) const {
    return nodes_[slot].leaf() ? 1 : 1 + count_nodes(slot + 1) + count_nodes(nodes_[slot].right);
  }

  uint32_t copy(uint32_t slot, std::vector<AabbTree::Node>& out) const {
    const auto index = static_cast<uint32_t>(out.size());
    out.push_back(nodes_[slot]);
    if (!nodes_[slot].leaf()) {
      copy(slot + 1, out);
      out[index].right = copy(nodes_[slot].right, out);
    }
    return index;
  }

  std::vector<uint32_t>& indices_;
  uint32_t leaf_size_;
  std::unique_ptr<Bounds[]> items_[2];  // of alternate levels, in the order of the tree built so far
  std::vector<AabbTree::Node> nodes_;
};

std::vector<AabbTree::Node> BuildNodes(std::span<const FloatBox> boxes, std::vector<uint32_t>& indices,
                                       uint32_t leaf_size) {
  return Builder(boxes, indices, leaf_size).build();
}

}  // namespace sdm::tree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::tree {

HWY_EXPORT(BuildNodes);

AabbTree build_aabb_tree(std::span<const FloatBox> boxes, std::vector<std::uint32_t> indices,
                         std::uint32_t leaf_size) {
  AabbTree tree;
  if (!indices.empty()) tree.nodes = HWY_DYNAMIC_DISPATCH(BuildNodes)(boxes, indices, leaf_size);
  tree.items = std::move(indices);
  return tree;
}

}  // namespace sdm::tree
#endif
