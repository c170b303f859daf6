#include "hierarchy/aabb_tree.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kParallelItems = 4096;  // below it a subtree is built by one thread

double half_area(const Box& box) {
  const Vec3 e = box.hi - box.lo;
  return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

class Builder {
 public:
  Builder(std::span<const Box> boxes, std::vector<std::uint32_t>& items, std::uint32_t leaf_size)
      : boxes_(boxes),
        items_(items),
        leaf_size_(leaf_size),
        centres_(boxes.size()),
        nodes_(2 * items.size()) {
    for (std::uint32_t i : items_) centres_[i] = centre(boxes_[i]);
  }

  std::vector<AabbTree::Node> build() {
    build(0, 0, static_cast<std::uint32_t>(items_.size()));
    std::vector<AabbTree::Node> compact;
    compact.reserve(nodes_.size());
    copy(0, compact);
    return compact;
  }

 private:
  // A subtree of n items has at most 2n − 1 nodes: giving each that many slots lets threads work without
  // talking, and copy() closes the gaps afterwards.
  void build(std::uint32_t slot, std::uint32_t begin, std::uint32_t end) {
    Box box, centre_box;
    for (std::uint32_t i = begin; i < end; ++i) {
      extend(box, boxes_[items_[i]]);
      extend(centre_box, centres_[items_[i]]);
    }
    AabbTree::Node& node = nodes_[slot];
    node.box = FloatBox::around(box);
    if (end - begin <= leaf_size_) {
      node.first = begin;
      node.count = end - begin;
      return;
    }
    const std::uint32_t middle = split(begin, end, centre_box);
    const std::uint32_t left = slot + 1, right = slot + 2 * (middle - begin);
    node.right = right;
    if (end - begin >= kParallelItems) {
      parallel_invoke([=, this] { build(left, begin, middle); }, [=, this] { build(right, middle, end); });
    } else {
      build(left, begin, middle);
      build(right, middle, end);
    }
  }

  // Splits where the heuristic (area × count, summed over both sides) is least over all bins of all axes.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, const Box& centre_box) {
    struct Bin {
      Box box;
      std::uint32_t count = 0;
    };
    double best_cost = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    const auto bin_of = [&](std::uint32_t item, int axis) {
      const double t =
          (centres_[item][axis] - centre_box.lo[axis]) / (centre_box.hi[axis] - centre_box.lo[axis]);
      return std::min(kBins - 1, static_cast<int>(kBins * t));
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centre_box.hi[axis] > centre_box.lo[axis])) continue;
      std::array<Bin, kBins> bins{};
      for (std::uint32_t i = begin; i < end; ++i) {
        Bin& bin = bins[bin_of(items_[i], axis)];
        extend(bin.box, boxes_[items_[i]]);
        ++bin.count;
      }
      std::array<double, kBins> right_cost{};
      Box box;
      std::uint32_t count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        if (bins[b].count > 0) extend(box, bins[b].box);
        count += bins[b].count;
        right_cost[b] = count > 0 ? count * half_area(box) : 0;
      }
      box = {};
      count = 0;
      for (int b = 0; b + 1 < kBins; ++b) {
        if (bins[b].count > 0) extend(box, bins[b].box);
        count += bins[b].count;
        if (count == 0 || count == end - begin) continue;
        const double cost = count * half_area(box) + right_cost[b + 1];
        if (cost < best_cost) best_cost = cost, best_axis = axis, best_bin = b;
      }
    }
    if (best_axis < 0) return begin + (end - begin) / 2;  // all centres agree
    const auto middle = std::partition(items_.begin() + begin, items_.begin() + end, [&](std::uint32_t item) {
      return bin_of(item, best_axis) <= best_bin;
    });
    return static_cast<std::uint32_t>(middle - items_.begin());
  }

  std::uint32_t copy(std::uint32_t slot, std::vector<AabbTree::Node>& out) const {
    const auto index = static_cast<std::uint32_t>(out.size());
    out.push_back(nodes_[slot]);
    if (!nodes_[slot].leaf()) {
      copy(slot + 1, out);
      out[index].right = copy(nodes_[slot].right, out);
    }
    return index;
  }

  std::span<const Box> boxes_;
  std::vector<std::uint32_t>& items_;
  std::uint32_t leaf_size_;
  std::vector<Vec3> centres_;
  std::vector<AabbTree::Node> nodes_;
};

}  // namespace

UnitFrame UnitFrame::of(const Box& box) {
  const Vec3 size = box.hi - box.lo;
  const double longest = std::max({size[0], size[1], size[2]});
  UnitFrame frame;
  frame.origin = centre(box);
  if (longest > 0) {
    int exponent = 0;
    std::frexp(0.5 * longest, &exponent);
    frame.scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));  // finite, and so is its inverse
  }
  return frame;
}

FloatBox FloatBox::around(const Box& box) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  FloatBox out;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = static_cast<float>(box.lo[k]);
    out.hi[k] = static_cast<float>(box.hi[k]);
    if (out.lo[k] > box.lo[k]) out.lo[k] = std::nextafter(out.lo[k], -inf);
    if (out.hi[k] < box.hi[k]) out.hi[k] = std::nextafter(out.hi[k], inf);
  }
  return out;
}

AabbTree build_aabb_tree(std::span<const Box> boxes, std::vector<std::uint32_t> indices,
                         std::uint32_t leaf_size) {
  AabbTree tree;
  tree.items = std::move(indices);
  if (!tree.items.empty()) tree.nodes = Builder(boxes, tree.items, leaf_size).build();
  return tree;
}

void refit(AabbTree& tree, std::span<const Box> boxes) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    AabbTree::Node& node = tree.nodes[i];
    if (node.leaf()) {
      Box box;
      for (std::uint32_t k = 0; k < node.count; ++k) extend(box, boxes[tree.items[node.first + k]]);
      node.box = FloatBox::around(box);
    } else {
      const FloatBox &left = tree.nodes[i + 1].box, &right = tree.nodes[node.right].box;
      for (int k = 0; k < 3; ++k) {
        node.box.lo[k] = std::min(left.lo[k], right.lo[k]);
        node.box.hi[k] = std::max(left.hi[k], right.hi[k]);
      }
    }
  }
}

}  // namespace sdm
