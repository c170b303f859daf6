// The sum of the solid angles of what is far from a ball. Included once for each set of vector instructions.
#if defined(SDM_FAR_FIELD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_FAR_FIELD_INL_H
#undef SDM_FAR_FIELD_INL_H
#else
#define SDM_FAR_FIELD_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/lanes/vec-inl.h"
#include "geometry/vec.h"
#include "inside/angles/expansions-inl.h"
#include "inside/angles/solid_angles.h"

#ifndef SDM_FAR_FIELD_ONCE
#define SDM_FAR_FIELD_ONCE
namespace sdm::inside {

/// Rounding in single precision.
inline constexpr double kHalfUlpF = 0x1p-24;

/// A ball around a centre that has no error, in the unit frame.
struct AngleBall {
  Vec3 centre{};
  double radius = 0;
  double displacement = 0;  ///< of its points, by rounding

  AngleBall() = default;
  AngleBall(const Vec3& about, double size) {
    for (int k = 0; k < 3; ++k) centre[k] = static_cast<float>(about[k]);
    radius = size + norm(about - centre);
    displacement = 2 * kHalfUlpF * radius + Expansions::kDisplacement * (1 + norm(centre) + radius);
  }
  /// Beyond this, single precision does not have the range.
  [[nodiscard]] bool in_range() const { return norm(centre) + radius < 0x1p20; }
};

/// Groups of faces and faces with a larger error, in solid angle, are not part of the far field.
struct FarLimits {
  float group, face;
};

}  // namespace sdm::inside
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::inside::HWY_NAMESPACE {

// A packet with more near faces and expansions, in vectors, costs more than its points one by one.
constexpr std::size_t kMostNear = 1500, kMostSteps = 4096;

// The sum of the solid angles of faces far from the packet: value + gradient · (q − centre), to within
// `error`.
struct FarField {
  double value = 0, error = 0, gradient[3] = {};
};

// Collects the far field of a ball, and the faces that are not part of it.
//
// A point q = q₀ + δ of the ball, |δ| ≤ ρ, sees a face point x at r₀ + u, where r₀ = c − q₀ and
// u = (x − c) − δ. So the series about r₀ has the terms of Expansions, with the gradient −∇(M·K)(r₀)·δ in
// addition, and the same remainder with R + ρ in place of R, and of the integral of |u|², which is at most
// (√∫|x − c|² dA + ρ√A)². The noise contains the rounding of the gradient, too: with |δ| < d it is rounded by
// less than 120·u·A/d².
class FarSum {
 public:
  // Sets `near` to the faces that are not part of the field. `whole`: only what the ball meets is not, and
  // groups whose error is larger than the limit at its centre.
  FarSum(const SolidAngles& angles, const AngleBall& ball, bool whole, const FarLimits& limits,
         std::vector<std::uint32_t>& near)
      : angles_(angles), ball_(ball), whole_(whole), limits_(limits), near_(near) {
    const ChildFloats d;
    value_ = error_ = seen_ = gradient_[0] = gradient_[1] = gradient_[2] = hn::Zero(d);
    radius_ = static_cast<float>((1 + 1e-6) * ball.radius);
    displacement_ = static_cast<float>((1 + 1e-6) * ball.displacement);
    near_.clear();
  }

  // Whether few faces are near.
  bool collect() {
    thread_local std::vector<std::uint32_t> open;
    open.assign(1, 0);
    while (!open.empty()) {
      const std::uint32_t index = open.back();
      open.pop_back();
      const tree::WideTree::Node& node = angles_.wide.nodes[index];
      for (std::uint32_t rest = add_children(index); rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        if (tree::WideTree::is_leaf(node.child[i]))
          add_faces(node.source[i]);
        else
          open.push_back(node.child[i]);
      }
      if (near_.size() > (whole_ ? 0 : kMostNear) || steps_ > kMostSteps) return false;
    }
    return true;
  }

  FarField sum() const {
    const ChildFloats d;
    const auto total = [&](ChildVec v) HWY_ATTR { return double{hn::GetLane(hn::SumOfLanes(d, v))}; };
    FarField field{.value = total(value_)};
    for (int k = 0; k < 3; ++k) field.gradient[k] = total(gradient_[k]);
    // A value and a gradient times δ are at most 9·A/g² together. The bounds are rounded in as many steps.
    const double rounding = 2 * kHalfUlpF * static_cast<double>(steps_ + 16);
    field.error = (1 + rounding + 1e-5) * (total(error_) + 9 * rounding * total(seen_));
    return field;
  }

 private:
  // The terms of groups of faces, or of faces.
  struct Terms {
    ChildVec r[3], moment[3];  // r = c − q₀
    ChildVec radius, area, second, noise;
    float displacement = 0;
  };

  // The bits of the children of a node that are not part of the far field.
  std::uint32_t add_children(std::uint32_t index) {
    const Expansions& e = angles_.expansions.nodes[index];
    const std::uint32_t children = angles_.wide.nodes[index].count;
    const ChildFloats d;
    std::uint32_t others = 0;
    for (size_t i = 0; i < children; i += hn::Lanes(d)) {
      Terms t;
      for (int k = 0; k < 3; ++k)
        t.r[k] = hn::Sub(hn::Load(d, e.centre[k] + i), hn::Set(d, static_cast<float>(ball_.centre[k])));
      lanes::HWY_NAMESPACE::load(d, e.moment, i, t.moment);
      t.radius = hn::Load(d, e.radius + i);
      t.area = hn::Load(d, e.area + i);
      t.second = hn::Load(d, e.second + i);
      t.noise = hn::Load(d, e.noise + i);
      t.displacement = displacement_;
      others |= add(t, children - i, limits_.group,
                    [&](ChildVec squared, ChildVec inverse)
                        HWY_ATTR { return expansion_value(e, i, t.r, squared, inverse); })
                << i;
    }
    return others;
  }
  // Adds the faces of a leaf.
  void add_faces(std::uint32_t leaf) {
    const FaceExpansions& e = angles_.expansions.faces;
    const tree::AabbTree& tree = angles_.faces.faces.tree;
    const std::size_t first = tree.nodes[leaf].first, end = first + tree.nodes[leaf].count;
    const ChildFloats d;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
      Terms t;
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        t.r[k] =
            hn::Sub(hn::LoadU(d, e.centre[axis].data() + i), hn::Set(d, static_cast<float>(ball_.centre[k])));
        t.moment[k] = hn::LoadU(d, e.moment[axis].data() + i);
      }
      // Rounded upwards.
      t.area = hn::Mul(hn::Sqrt(lanes::HWY_NAMESPACE::dot(t.moment, t.moment)), hn::Set(d, 1 + 1e-6F));
      t.area = hn::Add(t.area, hn::Set(d, 1e-18F));
      t.radius = hn::LoadU(d, e.radius.data() + i);
      t.second = hn::LoadU(d, e.second.data() + i);
      t.noise = hn::LoadU(d, e.noise.data() + i);
      t.displacement = displacement_ + static_cast<float>(FaceExpansions::kCentreRounding);
      const float most = whole_ ? std::numeric_limits<float>::max() : limits_.face;
      std::uint32_t others = add(t, end - i, most, [&](ChildVec, ChildVec inverse) HWY_ATTR {
        return hn::Mul(inverse, lanes::HWY_NAMESPACE::dot(t.moment, t.r));
      });
      for (; others != 0; others &= others - 1)
        near_.push_back(tree.items[i + static_cast<std::size_t>(std::countr_zero(others))]);
    }
  }
  // Adds the first `count` of those whose errors are small. The bits of the others.
  template <class Value>
  HWY_INLINE std::uint32_t add(const Terms& t, std::size_t count, float most, const Value& value) {
    const ChildFloats d;
    const auto squared = lanes::HWY_NAMESPACE::dot(t.r, t.r), distance = hn::Sqrt(squared);
    const auto ball = hn::Set(d, radius_), displacement = hn::Set(d, t.displacement);
    const auto radius = hn::Add(t.radius, ball);
    const auto gap = hn::MulSub(distance, hn::Set(d, 1 - 16 * 0x1p-24F), hn::Add(radius, displacement));
    const auto inverse_gap = hn::Div(hn::Set(d, 1), gap), by_gap2 = hn::Mul(inverse_gap, inverse_gap);
    const auto inverse = hn::Div(hn::Set(d, 1), hn::Mul(squared, distance));
    const auto root = hn::MulAdd(ball, hn::Sqrt(t.area), hn::Sqrt(t.second));
    const auto size = hn::NegMulAdd(hn::Set(d, 2), radius, hn::Mul(hn::Set(d, 3), distance));
    const auto per_second = hn::Mul(size, inverse), remainder = hn::Mul(hn::Mul(root, root), per_second);
    const auto steep = hn::Mul(hn::Add(displacement, displacement), hn::Mul(t.area, inverse_gap));
    const auto error = hn::Mul(hn::Add(hn::Add(remainder, t.noise), steep), by_gap2);
    const auto decides = whole_ ? hn::Mul(hn::Mul(t.second, per_second), by_gap2) : error;
    auto part = hn::And(hn::Gt(gap, hn::Zero(d)), hn::Le(decides, hn::Set(d, most)));
    part = hn::And(part, hn::FirstN(d, count));
    const auto add_to = [&](ChildVec& sum, ChildVec term)
                            HWY_ATTR { sum = hn::Add(sum, hn::IfThenElseZero(part, term)); };
    add_to(value_, value(squared, inverse));
    add_to(error_, error);
    add_to(seen_, hn::Mul(t.area, by_gap2));
    // 3·(M·r)·r/d⁵ − M/d³
    const auto along = hn::Mul(hn::Set(d, 3), hn::Div(lanes::HWY_NAMESPACE::dot(t.moment, t.r), squared));
    for (int k = 0; k < 3; ++k)
      add_to(gradient_[k], hn::Mul(inverse, hn::MulSub(along, t.r[k], t.moment[k])));
    ++steps_;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, part, bytes);
    return ~std::uint32_t{bytes[0]} & ((1u << std::min<std::size_t>(hn::Lanes(d), count)) - 1);
  }

  const SolidAngles& angles_;
  const AngleBall& ball_;
  bool whole_;
  FarLimits limits_;
  std::vector<std::uint32_t>& near_;
  float radius_, displacement_;
  ChildVec value_, error_, seen_, gradient_[3];
  std::size_t steps_ = 0;
};

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
