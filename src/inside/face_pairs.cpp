#include "inside/face_pairs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "inside/face_pairs.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "geometry/lanes/vec-inl.h"
#include "geometry/vec.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::inside::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using PairFloats = hn::CappedTag<float, TrianglePairs::kMost>;
using PairVec = hn::Vec<PairFloats>;
using PairVec3 = lanes::HWY_NAMESPACE::Vec3Of<PairVec>;
using PairMask = hn::Mask<PairFloats>;

// Looks for planes between triangles, one pair per lane. Any axis will do: only projections have to be
// rounded safely. Coordinates are at most 1, each within u = 2⁻²⁴ of itself, so that a projection is within
// 6·√3·u of itself times the length of the axis.
class Separation {
 public:
  Separation(const TrianglePairs& pairs, std::size_t first, double clearance) {
    const PairFloats d;
    for (int t = 0; t < 2; ++t)
      for (int j = 0; j < 3; ++j) corner_[t][j] = lanes::HWY_NAMESPACE::load(d, pairs.at[t][j], first);
    const auto rounding = hn::Set(d, 32 * 0x1p-24F);
    const auto wanted = hn::Set(d, static_cast<float>(clearance));
    const auto gap =
        hn::MulAdd(wanted, hn::Div(hn::Set(d, 1 + 1e-5F), hn::Load(d, pairs.unit + first)), rounding);
    squared_gap_ = hn::Mul(gap, gap);
    apart_ = hn::FirstN(d, 0);
  }

  // The axes are those of the separating axis theorem for triangles in space and in one plane, after the one
  // between their centres.
  PairMask search() {
    using lanes::HWY_NAMESPACE::add, lanes::HWY_NAMESPACE::sub, lanes::HWY_NAMESPACE::cross;
    const PairFloats d;
    PairVec3 edge[2][3], normal[2], sum[2];
    for (int t = 0; t < 2; ++t) {
      for (int j = 0; j < 3; ++j) edge[t][j] = sub(corner_[t][(j + 1) % 3], corner_[t][j]);
      normal[t] = cross(edge[t][0], edge[t][1]);
      sum[t] = add(corner_[t][0], add(corner_[t][1], corner_[t][2]));
    }
    tests(sub(sum[1], sum[0]));
    tests(normal[0]);
    tests(normal[1]);
    for (int t = 0; t < 2; ++t) {
      if (hn::AllTrue(d, apart_)) return apart_;
      for (int j = 0; j < 3; ++j) tests(cross(edge[t][j], normal[t]));
    }
    for (int i = 0; i < 3; ++i) {
      if (hn::AllTrue(d, apart_)) return apart_;
      for (int j = 0; j < 3; ++j) tests(cross(edge[0][i], edge[1][j]));
    }
    return apart_;
  }

 private:
  HWY_INLINE void tests(const PairVec3& axis) {
    using lanes::HWY_NAMESPACE::dot;
    const PairFloats d;
    PairVec least[2], most[2];
    for (int t = 0; t < 2; ++t) {
      const auto x = dot(axis, corner_[t][0]), y = dot(axis, corner_[t][1]), z = dot(axis, corner_[t][2]);
      least[t] = hn::Min(x, hn::Min(y, z));
      most[t] = hn::Max(x, hn::Max(y, z));
    }
    const auto gap = hn::Max(hn::Sub(least[0], most[1]), hn::Sub(least[1], most[0]));
    const auto squared = dot(axis, axis);
    const auto wide = hn::And(hn::Gt(gap, hn::Zero(d)), hn::Gt(squared, hn::Set(d, 1e-30F)));
    apart_ = hn::Or(apart_, hn::And(wide, hn::Gt(hn::Mul(gap, gap), hn::Mul(squared_gap_, squared))));
  }

  PairVec3 corner_[2][3];
  PairVec squared_gap_;
  PairMask apart_;
};

}  // namespace

std::uint32_t ApartBits(const TrianglePairs& pairs, double clearance) {
  const PairFloats d;
  std::uint32_t bits = 0;
  for (size_t i = 0; i < TrianglePairs::kMost; i += hn::Lanes(d)) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, Separation(pairs, i, clearance).search(), bytes);
    bits |= std::uint32_t{bytes[0]} << i;
  }
  return bits & ((1u << pairs.size()) - 1);
}

void AppendOverlapping(const tree::AabbTree& tree, const FaceBoxes& boxes, std::uint32_t leaf,
                       std::uint32_t other, std::vector<FacePair>& pairs) {
  const PairFloats d;
  // Places in the order of the leaves.
  const auto begin_of = [&](std::uint32_t node) {
    return static_cast<size_t>(tree.items_of(node).data() - tree.items.data());
  };
  const size_t begin = begin_of(leaf), end = begin + tree.items_of(leaf).size();
  const size_t begin_other = begin_of(other), end_other = begin_other + tree.items_of(other).size();
  for (size_t i = begin; i < end; i += hn::Lanes(d)) {
    PairVec lower[3], upper[3];
    for (size_t k = 0; k < 3; ++k) {
      lower[k] = hn::LoadU(d, boxes.lower[k].data() + i);
      upper[k] = hn::LoadU(d, boxes.upper[k].data() + i);
    }
    const size_t left = end - i;
    for (size_t j = begin_other; j < end_other; ++j) {
      // Within a leaf those before j only.
      const size_t count = leaf != other ? left : j > i ? std::min(left, j - i) : 0;
      auto meet = hn::FirstN(d, count);
      for (size_t k = 0; k < 3; ++k)
        meet = hn::And(meet, hn::And(hn::Le(lower[k], hn::Set(d, boxes.upper[k][j])),
                                     hn::Le(hn::Set(d, boxes.lower[k][j]), upper[k])));
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, meet, bytes);
      for (std::uint32_t bits = bytes[0]; bits != 0; bits &= bits - 1)
        pairs.push_back({tree.items[i + static_cast<size_t>(std::countr_zero(bits))], tree.items[j]});
    }
  }
}

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::inside {

HWY_EXPORT(ApartBits);
HWY_EXPORT(AppendOverlapping);

void FaceBoxes::set(const sites::SitesData& sites, double margin) {
  const Array<std::uint32_t>& faces = sites.tree.items;
  // Vectors read beyond the last one.
  for (auto* boxes : {&lower, &upper})
    for (std::vector<float>& values : *boxes) values.resize(faces.size() + TrianglePairs::kMost);
  const auto by = static_cast<float>(margin);
  parallel_for(faces.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Box exact;
      for (const std::uint32_t v : sites.mesh.triangles[faces[i]])
        extend(exact, sites.frame.to_unit(sites.mesh.positions[v]));
      const auto box = tree::FloatBox::around(exact);
      for (std::size_t k = 0; k < 3; ++k) {
        lower[k][i] = box.lower[k] - by;
        upper[k][i] = box.upper[k] + by;
      }
    }
  });
}

void append_overlapping(const sites::SitesData& sites, const FaceBoxes& boxes, std::uint32_t leaf,
                        std::uint32_t other, std::vector<FacePair>& pairs) {
  HWY_DYNAMIC_DISPATCH(AppendOverlapping)(sites.tree, boxes, leaf, other, pairs);
}

void TrianglePairs::add(const Corners& a, const Corners& b) {
  double largest = 0;
  for (const Corners* t : {&a, &b})
    for (const Vec3& corner : *t)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(corner[k] - a[0][k]));
  // If all corners are in one point, no plane is found.
  const double inverse = largest > 0 ? 1 / largest : 0;
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t k = 0; k < 3; ++k) {
      at[0][j][k][count_] = static_cast<float>(inverse * (a[j][k] - a[0][k]));
      at[1][j][k][count_] = static_cast<float>(inverse * (b[j][k] - a[0][k]));
    }
  unit[count_++] = static_cast<float>(largest > 0 ? largest : 1);
}

std::uint32_t TrianglePairs::apart(double clearance) const {
  return HWY_DYNAMIC_DISPATCH(ApartBits)(*this, clearance);
}

}  // namespace sdm::inside
#endif
