#include "sites/bounding_cylinders.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sites/bounding_cylinders.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "geometry/lanes/vec-inl.h"
#include "sites/check_numbers.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::sites::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

constexpr size_t kLanes = BoundingCylinders::kWidth;
using Lanes = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<Lanes>;

// Up to eight cylinders, around which another cylinder is put.
struct Cylinders {
  const BoundingCylinders& at;
  size_t count;
};

// The faces of a leaf; lanes beyond the last one repeat it.
struct Faces {
  alignas(64) float corner[3][3][kLanes];  // by corner and axis

  void load(const Regions& regions, size_t leaf) {
    const size_t first = regions.leaves[leaf], last = regions.leaves[leaf + 1] - 1;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const Triangle& corners = regions.places.corners[std::min(first + lane, last)];
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) corner[c][k][lane] = regions.points[corners[c]].point[k];
    }
  }
};

HWY_INLINE Vec sine(Vec cosine) {
  const Lanes d;
  const Vec one = hn::Set(d, 1 + kCylinderRounding);
  return hn::Sqrt(hn::Max(hn::NegMulAdd(cosine, cosine, one), hn::Zero(d)));
}

// A mean of axes, up to their signs.
class MeanAxis {
 public:
  HWY_INLINE MeanAxis() {
    for (Vec& x : sum_) x = hn::Zero(Lanes());
  }
  HWY_INLINE void add(const Faces& faces) {
    const Lanes d;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
      Vec corner[3][3], u[3], v[3], area[3];
      for (int c = 0; c < 3; ++c) load(d, faces.corner[c], i, corner[c]);
      for (int k = 0; k < 3; ++k) u[k] = hn::Sub(corner[1][k], corner[0][k]);
      for (int k = 0; k < 3; ++k) v[k] = hn::Sub(corner[2][k], corner[0][k]);
      for (int k = 0; k < 3; ++k)
        area[k] = hn::MulSub(u[(k + 1) % 3], v[(k + 2) % 3], hn::Mul(u[(k + 2) % 3], v[(k + 1) % 3]));
      add(area, hn::Set(d, 1.0f));
    }
  }
  HWY_INLINE void add(const Cylinders& cylinders) {
    const Lanes d;
    for (size_t i = 0; i < cylinders.count; i += hn::Lanes(d)) {
      Vec axis[3];
      load(d, cylinders.at.axis, i, axis);
      const Vec radius = hn::Load(d, cylinders.at.radius + i);
      add(axis, hn::IfThenElseZero(hn::FirstN(d, cylinders.count - i), hn::Mul(radius, radius)));
    }
  }
  // A unit vector, or 0.
  void get(float (&mean)[3]) const {
    const Lanes d;
    alignas(64) float sums[3][kLanes];
    for (int k = 0; k < 3; ++k) hn::Store(sum_[k], d, sums[k]);
    for (float& x : mean) x = 0;
    for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      float with = 0;
      for (int k = 0; k < 3; ++k) with += mean[k] * sums[k][lane];
      for (int k = 0; k < 3; ++k) mean[k] += with < 0 ? -sums[k][lane] : sums[k][lane];
    }
    const float squared = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
    const float inverse = squared > 1e-30f ? 1 / std::sqrt(squared) : 0;
    for (float& x : mean) x *= inverse;
  }

 private:
  HWY_INLINE void add(const Vec (&axis)[3], Vec weight) {
    const Vec turned = hn::CopySign(weight, dot(sum_, axis));
    for (int k = 0; k < 3; ++k) sum_[k] = hn::MulAdd(turned, axis[k], sum_[k]);
  }

  Vec sum_[3];
};

// How far parts extend along an axis, and from the line through a point in its direction.
class Extents {
 public:
  HWY_INLINE Extents(const float (&axis)[3], const float (&through)[3]) {
    const Lanes d;
    for (int k = 0; k < 3; ++k) {
      axis_[k] = hn::Set(d, axis[k]);
      through_[k] = hn::Set(d, through[k]);
    }
    least_ = hn::Inf(d);
    most_ = hn::Neg(hn::Inf(d));
    squared_reach_ = hn::Zero(d);
  }
  HWY_INLINE void add(const Faces& faces) {
    const Lanes d;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(d))
      for (int c = 0; c < 3; ++c) {
        Vec from[3];
        load(d, faces.corner[c], i, from);
        for (int k = 0; k < 3; ++k) from[k] = hn::Sub(from[k], through_[k]);
        const Vec along = dot(from, axis_);
        least_ = hn::Min(least_, along);
        most_ = hn::Max(most_, along);
        squared_reach_ = hn::Max(squared_reach_, squared_aside(from, along));
      }
  }
  HWY_INLINE void add(const Cylinders& cylinders) {
    const Lanes d;
    for (size_t i = 0; i < cylinders.count; i += hn::Lanes(d)) {
      Vec from[3], axis[3];
      load(d, cylinders.at.centre, i, from);
      load(d, cylinders.at.axis, i, axis);
      for (int k = 0; k < 3; ++k) from[k] = hn::Sub(from[k], through_[k]);
      const Vec radius = hn::Load(d, cylinders.at.radius + i);
      const Vec half_height = hn::Load(d, cylinders.at.half_height + i);
      const Vec along = dot(from, axis_), across = sine(dot(axis, axis_));
      const Vec extent = hn::MulAdd(radius, across, half_height);
      const Vec reach =
          hn::Add(hn::Sqrt(squared_aside(from, along)), hn::MulAdd(half_height, across, radius));
      const auto used = hn::FirstN(d, cylinders.count - i);
      least_ = hn::Min(least_, hn::IfThenElse(used, hn::Sub(along, extent), hn::Inf(d)));
      most_ = hn::Max(most_, hn::IfThenElse(used, hn::Add(along, extent), hn::Neg(hn::Inf(d))));
      squared_reach_ = hn::Max(squared_reach_, hn::IfThenElseZero(used, hn::Mul(reach, reach)));
    }
  }
  float least() const { return hn::GetLane(hn::MinOfLanes(Lanes(), least_)); }
  float most() const { return hn::GetLane(hn::MaxOfLanes(Lanes(), most_)); }
  float reach() const { return std::sqrt(hn::GetLane(hn::MaxOfLanes(Lanes(), squared_reach_))); }

 private:
  static HWY_INLINE Vec squared_aside(const Vec (&from)[3], Vec along) {
    const Lanes d;
    const Vec squared = hn::Mul(hn::Set(d, 1 + kCylinderRounding), dot(from, from));
    return hn::Max(hn::NegMulAdd(along, along, squared), hn::Zero(d));
  }

  Vec axis_[3], through_[3], least_, most_, squared_reach_;
};

// Puts the cylinder of child i of a node around the parts that for_each_part calls its argument with.
template <class ForEachPart>
void Enclose(const tree::WideTree::Node& node, size_t i, const ForEachPart& for_each_part,
             BoundingCylinders& result) {
  float axis[3], middle[3], squared = 0;
  MeanAxis mean;
  for_each_part([&](const auto& parts) HWY_ATTR { mean.add(parts); });
  mean.get(axis);
  for (int k = 0; k < 3; ++k) {
    middle[k] = 0.5f * (node.lower[k][i] + node.upper[k][i]);
    const float half = 0.5f * (node.upper[k][i] - node.lower[k][i]);
    squared += half * half;
  }
  Extents extents(axis, middle);
  for_each_part([&](const auto& parts) HWY_ATTR { extents.add(parts); });

  const bool ball = axis[0] == 0 && axis[1] == 0 && axis[2] == 0;
  const float shift = ball ? 0 : 0.5f * (extents.least() + extents.most());
  for (int k = 0; k < 3; ++k) {
    result.axis[k][i] = axis[k];
    result.centre[k][i] = middle[k] + shift * axis[k];
  }
  const auto enlarged = [](float length) { return (1 + kCylinderRounding) * length + kCylinderRounding; };
  // No point of the box is farther away than its corners.
  result.radius[i] = enlarged(std::min(extents.reach(), std::sqrt(squared)));
  result.half_height[i] = ball ? 0 : enlarged(0.5f * (extents.most() - extents.least()));
}

// Computes the cylinders of a child of a node that has few leaves, and of all nodes below it.
class EncloseGroup {
 public:
  EncloseGroup(CylinderTree& tree, const tree::WideTree& wide, const Regions& regions)
      : tree_(tree), wide_(wide), regions_(regions) {}

  void run(uint32_t n, uint32_t i) {
    const CylinderTree::LeafRange range = tree_.leaves_of(wide_.nodes[n].child[i]);
    first_ = range.first;
    for (uint32_t leaf = 0; leaf < range.count; ++leaf) faces_[leaf].load(regions_, first_ + leaf);
    enclose(n, i);
  }

 private:
  void enclose(uint32_t n, uint32_t i) {
    const uint32_t child = wide_.nodes[n].child[i];
    const CylinderTree::LeafRange range = tree_.leaves_of(child);
    const Faces* faces = faces_ + (range.first - first_);
    Enclose(
        wide_.nodes[n], i,
        [&](const auto& add) HWY_ATTR {
          for (uint32_t leaf = 0; leaf < range.count; ++leaf) add(faces[leaf]);
        },
        tree_.nodes[n]);
    if (tree::WideTree::is_leaf(child)) return;
    for (uint32_t j = 0; j < wide_.nodes[child].count; ++j) enclose(child, j);
  }

  CylinderTree& tree_;
  const tree::WideTree& wide_;
  const Regions& regions_;
  uint32_t first_ = 0;
  Faces faces_[CylinderTree::kFewLeaves];
};

void EncloseFaces(CylinderTree& tree, const tree::WideTree& wide, const Regions& regions, size_t begin,
                  size_t end) {
  EncloseGroup group(tree, wide, regions);
  for (auto n = static_cast<uint32_t>(begin); n < end; ++n)
    if (n == 0 || !tree.has_few_leaves(n))
      for (uint32_t i = 0; i < wide.nodes[n].count; ++i)
        if (tree.has_few_leaves(wide.nodes[n].child[i])) group.run(n, i);
}

// Encloses, for inner nodes, the cylinders of their grandchildren, which are thinner than those of the
// children.
void EncloseCylinders(CylinderTree& tree, const tree::WideTree& wide) {
  for (auto n = static_cast<uint32_t>(wide.nodes.size()); n-- > 0;)
    for (uint32_t i = 0; i < wide.nodes[n].count; ++i) {
      const uint32_t child = wide.nodes[n].child[i];
      if (tree.has_few_leaves(child)) continue;
      const tree::WideTree::Node& below = wide.nodes[child];
      Enclose(
          wide.nodes[n], i,
          [&](const auto& add) HWY_ATTR {
            if (below.leaves != 0) return add(Cylinders{tree.nodes[child], below.count});
            for (uint32_t j = 0; j < below.count; ++j)
              add(Cylinders{tree.nodes[below.child[j]], wide.nodes[below.child[j]].count});
          },
          tree.nodes[n]);
    }
}

}  // namespace sdm::sites::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::sites {

using tree::WideTree;

HWY_EXPORT(EncloseFaces);
HWY_EXPORT(EncloseCylinders);

CylinderTree::CylinderTree(const WideTree& wide, const Regions& regions) {
  if (regions.leaves.size() <= kLeastLeaves) return;
  nodes.resize(wide.nodes.size());
  find_leaves(wide);
  parallel_for(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(EncloseFaces)(*this, wide, regions, begin, end);
  });
  HWY_DYNAMIC_DISPATCH(EncloseCylinders)(*this, wide);
}

bool CylinderTree::set_nodes(Array<BoundingCylinders> stored, const WideTree& wide) {
  if (!stored.empty() && stored.size() != wide.nodes.size()) return false;
  nodes = std::move(stored);
  leaves_.clear();
  if (!nodes.empty()) find_leaves(wide);
  return true;
}

bool CylinderTree::have_valid_numbers() const {
  const std::span<const BoundingCylinders> all(nodes);
  return std::ranges::all_of(all, [](const BoundingCylinders& cylinders) {
    return are_within({&cylinders.centre[0][0], sizeof cylinders / sizeof(float)}, kUnitReach);
  });
}

// Children follow their parents, and the leaves below a node each other.
void CylinderTree::find_leaves(const WideTree& wide) {
  leaves_.resize(wide.nodes.size());
  for (std::size_t n = wide.nodes.size(); n-- > 0;) {
    leaves_[n] = {kNone, 0};
    for (std::uint32_t i = 0; i < wide.nodes[n].count; ++i) {
      const LeafRange child = leaves_of(wide.nodes[n].child[i]);
      leaves_[n] = {std::min(leaves_[n].first, child.first), leaves_[n].count + child.count};
    }
  }
}

CylinderTree::LeafRange CylinderTree::leaves_of(std::uint32_t child) const {
  if (WideTree::is_leaf(child)) return {WideTree::leaf_number(child), 1};
  return leaves_[child];
}

}  // namespace sdm::sites
#endif
