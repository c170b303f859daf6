#include "query/inside/angles/packet_angles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/inside/angles/packet_angles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/cancellation.h"
#include "geometry/lanes/vec-inl.h"
#include "geometry/vec.h"
#include "query/inside/angles/expansions-inl.h"

#ifndef SDM_PACKET_ANGLES_ONCE
#define SDM_PACKET_ANGLES_ONCE
namespace sdm::inside {
namespace {

// Rounding in single precision.
constexpr double kHalfUlpF = 0x1p-24;
// Expansions with larger errors, in solid angle, are replaced by those of their parts, or by faces.
constexpr float kMostErrorOfPacket = 0.05F;
// Sums decide little with larger errors: beside a surface they are half a turn, 2π, from the limit.
constexpr double kUsefulError = 4.5;
// With more near faces and expansions than this, in vectors, a packet costs more than its points one by one.
constexpr std::size_t kMostNear = 1500, kMostSteps = 4096;
// Beyond this in the unit frame, single precision does not have the range.
constexpr double kFarthestPacket = 0x1p20;

// A face relative to the centre of the packet, in the unit frame.
struct PacketFace {
  float corner[3][3];
  float displacement;  // of a corner and a point, relative to each other, by rounding
};

// Points relative to their centre, which has no error, in the unit frame.
struct PacketPoints {
  Vec3 centre{};
  alignas(64) float at[3][kPacket] = {};
  double radius = 0;        // of a ball around the centre
  double displacement = 0;  // by rounding

  PacketPoints(const UnitFrame& frame, std::span<const Vec3> points) {
    Box box;
    for (const Vec3& p : points) extend(box, frame.to_unit(p));
    for (int k = 0; k < 3; ++k) centre[k] = static_cast<float>(0.5 * (box.lo[k] + box.hi[k]));
    for (std::size_t i = 0; i < kPacket; ++i) {
      const Vec3 offset = frame.to_unit(points[std::min(i, points.size() - 1)]) - centre;
      radius = std::max(radius, norm(offset));
      for (int k = 0; k < 3; ++k) at[k][i] = static_cast<float>(offset[k]);
    }
    displacement = 2 * kHalfUlpF * radius + Expansions::kDisplacement * (1 + norm(centre) + radius);
  }
};

}  // namespace
}  // namespace sdm::inside
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::inside::HWY_NAMESPACE {
namespace {

using PointFloats = hn::CappedTag<float, kPacket>;
using PointVec = hn::Vec<PointFloats>;

// What is far from the packet: value + gradient · (q − centre), to within `error`.
struct FarField {
  double value = 0, error = 0, gradient[3] = {};
};

// Collects the far field and the faces that are not part of it.
//
// A point q = q₀ + δ of the packet, |δ| ≤ ρ, sees a face point x at r₀ + u, where r₀ = c − q₀ and
// u = (x − c) − δ. So the series about r₀ has the terms of Expansions, with the gradient −∇(M·K)(r₀)·δ in
// addition, and the same remainder with R + ρ in place of R, and of the integral of |u|², which is at most
// (√∫|x − c|² dA + ρ√A)². The noise contains the rounding of the gradient, too: with |δ| < d it is rounded by
// less than 120·u·A/d².
class FarSum {
 public:
  // Sets `near` to the faces.
  FarSum(const SolidAngles& angles, const PacketPoints& points, float most, std::vector<std::uint32_t>& near)
      : angles_(angles), points_(points), most_(most), near_(near) {
    const ChildFloats d;
    value_ = error_ = seen_ = gradient_[0] = gradient_[1] = gradient_[2] = hn::Zero(d);
    radius_ = static_cast<float>((1 + 1e-6) * points.radius);
    displacement_ = static_cast<float>((1 + 1e-6) * points.displacement);
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
      if (near_.size() > kMostNear || steps_ > kMostSteps) return false;
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
  // Of groups of faces, or of faces.
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
        t.r[k] = hn::Sub(hn::Load(d, e.centre[k] + i), hn::Set(d, static_cast<float>(points_.centre[k])));
      lanes::HWY_NAMESPACE::load(d, e.moment, i, t.moment);
      t.radius = hn::Load(d, e.radius + i), t.area = hn::Load(d, e.area + i);
      t.second = hn::Load(d, e.second + i), t.noise = hn::Load(d, e.noise + i);
      t.displacement = displacement_;
      others |= add(t, children - i,
                    [&](ChildVec squared, ChildVec inverse)
                        HWY_ATTR { return expansion_value(e, i, t.r, squared, inverse); })
                << i;
    }
    return others;
  }
  // Of a leaf.
  void add_faces(std::uint32_t leaf) {
    const FaceExpansions& e = angles_.expansions.faces;
    const tree::AabbTree& tree = angles_.faces.faces.tree;
    const std::size_t first = tree.nodes[leaf].first, end = first + tree.nodes[leaf].count;
    const ChildFloats d;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
      Terms t;
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        t.r[k] = hn::Sub(hn::LoadU(d, e.centre[axis].data() + i),
                         hn::Set(d, static_cast<float>(points_.centre[k])));
        t.moment[k] = hn::LoadU(d, e.moment[axis].data() + i);
      }
      // Not smaller than it is.
      t.area = hn::Mul(hn::Sqrt(lanes::HWY_NAMESPACE::dot(t.moment, t.moment)), hn::Set(d, 1 + 1e-6F));
      t.area = hn::Add(t.area, hn::Set(d, 1e-18F));
      t.radius = hn::LoadU(d, e.radius.data() + i), t.second = hn::LoadU(d, e.second.data() + i);
      t.noise = hn::LoadU(d, e.noise.data() + i);
      t.displacement = displacement_ + static_cast<float>(FaceExpansions::kCentreRounding);
      std::uint32_t others = add(t, end - i, [&](ChildVec, ChildVec inverse) HWY_ATTR {
        return hn::Mul(inverse, lanes::HWY_NAMESPACE::dot(t.moment, t.r));
      });
      for (; others != 0; others &= others - 1)
        near_.push_back(tree.items[i + static_cast<std::size_t>(std::countr_zero(others))]);
    }
  }
  // Adds the first `count` of those whose errors are small. The bits of the others.
  template <class Value>
  HWY_INLINE std::uint32_t add(const Terms& t, std::size_t count, const Value& value) {
    const ChildFloats d;
    const auto squared = lanes::HWY_NAMESPACE::dot(t.r, t.r), distance = hn::Sqrt(squared);
    const auto packet = hn::Set(d, radius_), displacement = hn::Set(d, t.displacement);
    const auto radius = hn::Add(t.radius, packet);
    const auto gap = hn::MulSub(distance, hn::Set(d, 1 - 16 * 0x1p-24F), hn::Add(radius, displacement));
    const auto inverse_gap = hn::Div(hn::Set(d, 1), gap), by_gap2 = hn::Mul(inverse_gap, inverse_gap);
    const auto inverse = hn::Div(hn::Set(d, 1), hn::Mul(squared, distance));
    const auto root = hn::MulAdd(packet, hn::Sqrt(t.area), hn::Sqrt(t.second));
    const auto size = hn::NegMulAdd(hn::Set(d, 2), radius, hn::Mul(hn::Set(d, 3), distance));
    const auto remainder = hn::Mul(hn::Mul(root, root), hn::Mul(size, inverse));
    const auto steep = hn::Mul(hn::Add(displacement, displacement), hn::Mul(t.area, inverse_gap));
    const auto error = hn::Mul(hn::Add(hn::Add(remainder, t.noise), steep), by_gap2);
    auto part = hn::And(hn::Gt(gap, hn::Zero(d)), hn::Le(error, hn::Set(d, most_)));
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
  const PacketPoints& points_;
  float most_;
  std::vector<std::uint32_t>& near_;
  float radius_, displacement_;
  ChildVec value_, error_, seen_, gradient_[3];
  std::size_t steps_ = 0;
};

void gather_faces(const SolidAngles& angles, const PacketPoints& points, std::span<const std::uint32_t> near,
                  std::vector<PacketFace>& faces) {
  faces.clear();
  for (const std::uint32_t index : near) {
    PacketFace& face = faces.emplace_back();
    double farthest = 0;
    const std::array<Vec3, 3> corners = angles.faces.corners(index);
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 corner = angles.faces.faces.frame.to_unit(corners[j]) - points.centre;
      farthest = std::max(farthest, std::abs(corner[0]) + std::abs(corner[1]) + std::abs(corner[2]));
      for (int k = 0; k < 3; ++k) face.corner[j][k] = static_cast<float>(corner[k]);
    }
    face.displacement = static_cast<float>(1.01 * (kHalfUlpF * farthest + points.displacement));
  }
}

// Sums of solid angles, one per lane, as SolidAngleSum has them.
//
// With a, b, c the corners relative to a point, L = |a||b||c|, and z the complex number of half_solid_angle()
// over L. By u = 2⁻²⁴, z is rounded by less than 128·u. A displacement of each corner by η changes the
// numerator by at most √17·η·(|b||c| + |a||c| + |a||b|)·(1 + η/l)², where l is the least length, so z by less
// than 8·η·(1/|a| + 1/|b| + 1/|c|), unless η > 0.39·l: then eight times this bound exceeds |z| ≤ √17, and the
// angle counts as unknown. Lengths whose product underflows make the bound infinite or no number.
class NearSum {
 public:
  NearSum() {
    const PointFloats d;
    real_ = hn::Set(d, 1);
    imaginary_ = turns_ = error_ = hn::Zero(d);
  }

  HWY_INLINE void add(const PacketFace& face, PointVec x, PointVec y, PointVec z) {
    using lanes::HWY_NAMESPACE::cross, lanes::HWY_NAMESPACE::dot;
    const PointFloats d;
    const lanes::HWY_NAMESPACE::Vec3Of<PointVec> q{x, y, z};
    const auto a = sub(lanes::HWY_NAMESPACE::splat(d, face.corner[0]), q),
               b = sub(lanes::HWY_NAMESPACE::splat(d, face.corner[1]), q),
               c = sub(lanes::HWY_NAMESPACE::splat(d, face.corner[2]), q);
    const auto la = hn::Sqrt(dot(a, a)), lb = hn::Sqrt(dot(b, b)), lc = hn::Sqrt(dot(c, c));
    const auto bc = hn::Mul(lb, lc), one = hn::Set(d, 1), inverse = hn::Div(one, hn::Mul(la, bc));
    const auto lengths = hn::MulAdd(la, hn::Add(lb, lc), bc);
    const auto dots = hn::MulAdd(dot(a, b), lc, hn::MulAdd(dot(b, c), la, hn::Mul(dot(c, a), lb)));
    const auto real = hn::MulAdd(dots, inverse, one), imaginary = hn::Mul(dot(a, cross(b, c)), inverse);
    const auto bound =
        hn::MulAdd(hn::Set(d, 8 * face.displacement), hn::Mul(lengths, inverse), hn::Set(d, 128 * 0x1p-24F));
    multiply(real, imaginary, bound);
  }
  // The sum, to within 0.01 and error().
  PointVec sum() const {
    const PointFloats d;
    const float whole = static_cast<float>(4 * std::numbers::pi);
    return hn::MulAdd(hn::Set(d, whole), turns_, hn::Mul(hn::Set(d, 2), argument()));
  }
  PointVec error() const { return error_; }

 private:
  HWY_INLINE void multiply(PointVec real, PointVec imaginary, PointVec bound) {
    const PointFloats d;
    const auto zero = hn::Zero(d);
    const auto squared = hn::MulAdd(real, real, hn::Mul(imaginary, imaginary));
    const auto either_side = hn::And(hn::Le(real, bound), hn::Le(hn::Abs(imaginary), bound));
    const auto eight = hn::Mul(hn::Set(d, 8), bound);
    const auto known = hn::AndNot(either_side, hn::Gt(squared, hn::Mul(eight, eight)));
    // Of any size near 1 for the product, and to within a tenth for the bound, which has as much to spare.
    const auto inverse = hn::ApproximateReciprocalSqrt(squared);
    const auto turned = hn::MulAdd(eight, inverse, hn::Set(d, 16 * 0x1p-24F));
    error_ = hn::Add(error_, hn::IfThenElse(known, turned, hn::Inf(d)));
    const auto re = hn::Mul(real, inverse), im = hn::Mul(imaginary, inverse);
    const auto next_real = hn::MulSub(real_, re, hn::Mul(imaginary_, im));
    const auto next = hn::MulAdd(real_, im, hn::Mul(imaginary_, re));
    const auto up = hn::Ge(imaginary_, zero), factor_up = hn::Ge(im, zero), next_up = hn::Ge(next, zero);
    const auto more = hn::AndNot(next_up, hn::And(up, factor_up));
    const auto fewer = hn::AndNot(hn::Or(up, factor_up), next_up);
    turns_ = hn::Add(turns_, hn::IfThenElseZero(more, hn::Set(d, 1)));
    turns_ = hn::Sub(turns_, hn::IfThenElseZero(fewer, hn::Set(d, 1)));
    real_ = next_real, imaginary_ = next;
  }
  // The argument of the product to within 0.0038 (S. Rajan et al., Efficient approximations for the
  // arctangent function, 2006).
  PointVec argument() const {
    const PointFloats d;
    const auto x = hn::Abs(real_), y = hn::Abs(imaginary_);
    const auto t = hn::Div(hn::Min(x, y), hn::Max(x, y));
    const auto slope = hn::NegMulAdd(hn::Set(d, 0.273F), t, hn::Set(d, 0.7853982F + 0.273F));
    auto angle = hn::Mul(t, slope);
    angle = hn::IfThenElse(hn::Gt(y, x), hn::Sub(hn::Set(d, 1.5707964F), angle), angle);
    angle = hn::IfThenElse(hn::Lt(real_, hn::Zero(d)), hn::Sub(hn::Set(d, 3.1415927F), angle), angle);
    return hn::IfThenElse(hn::Lt(imaginary_, hn::Zero(d)), hn::Neg(angle), angle);
  }

  PointVec real_, imaginary_, turns_, error_;
};

// The sums of both, compared with the limits.
PacketSides compare(const FarField& far, std::span<const PacketFace> faces, const PacketPoints& points,
                    std::span<const double> limits) {
  const PointFloats d;
  alignas(64) float from_limit[kPacket] = {};
  for (std::size_t i = 0; i < limits.size(); ++i) from_limit[i] = static_cast<float>(far.value - limits[i]);
  PacketSides sides;
  for (size_t i = 0; i < limits.size(); i += hn::Lanes(d)) {
    const auto x = hn::Load(d, points.at[0] + i), y = hn::Load(d, points.at[1] + i),
               z = hn::Load(d, points.at[2] + i);
    NearSum near;
    for (const PacketFace& face : faces) near.add(face, x, y, z);
    const auto slope = [&](int k) HWY_ATTR { return hn::Set(d, static_cast<float>(far.gradient[k])); };
    const auto linear = hn::MulAdd(slope(0), x, hn::MulAdd(slope(1), y, hn::Mul(slope(2), z)));
    const auto start = hn::Load(d, from_limit + i), angle = near.sum();
    const auto total = hn::Add(hn::Add(start, linear), angle);
    // The argument is approximate, and the rest rounded in few steps.
    const auto size = hn::Add(hn::Add(hn::Abs(start), hn::Abs(angle)), hn::Abs(linear));
    const auto error = hn::Add(hn::MulAdd(hn::Set(d, 1e-5F), size, near.error()),
                               hn::Set(d, static_cast<float>(1.001 * far.error + 0.01)));
    const auto bits = [&](auto mask) HWY_ATTR {
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, mask, bytes);
      return (std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8) << i;
    };
    sides.known |= bits(hn::Gt(hn::Abs(total), error));
    sides.above |= bits(hn::Gt(total, hn::Zero(d)));
  }
  sides.known &= (1u << limits.size()) - 1;
  sides.above &= sides.known;
  return sides;
}

}  // namespace

PacketSides SidesOfPacket(const SolidAngles& angles, std::span<const Vec3> points,
                          std::span<const double> limits) {
  const PacketPoints packet(angles.faces.faces.frame, points);
  if (!(norm(packet.centre) + packet.radius < kFarthestPacket)) return {};
  thread_local std::vector<std::uint32_t> near;
  thread_local std::vector<PacketFace> faces;
  FarField field;
  float most = kMostErrorOfPacket;
  for (const int last : {0, 1}) {
    poll();
    FarSum far(angles, packet, most, near);
    if (!far.collect()) return {};
    field = far.sum();
    if (last != 0 || field.error < kUsefulError) break;
    // The sum of the errors is about as the root of the largest.
    const double factor = 0.8 * kUsefulError / field.error;
    most *= static_cast<float>(std::max(factor * factor, 1.0 / 16));
  }
  gather_faces(angles, packet, near, faces);
  return compare(field, faces, packet, limits);
}

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::inside {

HWY_EXPORT(SidesOfPacket);

PacketSides sides_of_packet(const SolidAngles& angles, std::span<const Vec3> points,
                            std::span<const double> limits) {
  if (points.empty()) return {};
  if (angles.empty()) {
    PacketSides sides{(1u << points.size()) - 1, 0};
    for (std::size_t i = 0; i < points.size(); ++i) sides.above |= (limits[i] < 0 ? 1u : 0u) << i;
    return sides;
  }
  return HWY_DYNAMIC_DISPATCH(SidesOfPacket)(angles, points, limits);
}

}  // namespace sdm::inside
#endif
