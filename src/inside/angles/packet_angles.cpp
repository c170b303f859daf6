#include "inside/angles/packet_angles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "inside/angles/packet_angles.cpp"
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
#include "inside/angles/far_field-inl.h"
#include "inside/angles/solid_angle.h"

#ifndef SDM_PACKET_ANGLES_ONCE
#define SDM_PACKET_ANGLES_ONCE
namespace sdm::inside {
namespace {

// Expansions with larger errors, in solid angle, are replaced by those of their parts, or by faces.
constexpr FarLimits kLimitsOfPoint{0.3F, 0.3F}, kLimitsOfBall{0.04F, 0.04F};
// Sums decide little with larger errors: beside a surface they are half a turn, 2π, from the limit.
constexpr double kUsefulError = 4.5;

// The limits with which the sum of all errors stays below what is useful, by those of the packets of the same
// shape before on this thread. Answers do not depend on them.
class LearnedLimits {
 public:
  [[nodiscard]] FarLimits of(std::uint64_t shape) {
    constexpr float kFirst = 0.05F, kOfFaces = 0.5F;
    if (shape != shape_) {
      most_ = kFirst;
      shape_ = shape;
    }
    return {most_, kOfFaces * most_};
  }
  // Whether a sum with this error is useful. If not, the limits are smaller now.
  [[nodiscard]] bool learn(double error) {
    constexpr float kGrowth = 1.05F, kLargest = 0.1F;
    if (error < 0.7 * kUsefulError) most_ = std::min(kGrowth * most_, kLargest);
    if (error < kUsefulError) return true;
    // The sum of the errors is about as the root of the largest.
    const double factor = 0.8 * kUsefulError / error;
    most_ *= static_cast<float>(std::max(factor * factor, 1.0 / 16));
    return false;
  }

 private:
  float most_ = 0;
  std::uint64_t shape_ = 0;
};

// A face relative to the centre of the packet, in the unit frame.
struct PacketFace {
  float corner[3][3];
  float displacement;  // of a corner and a point, relative to each other, by rounding
};

// Points relative to the centre of a ball that contains them, in the unit frame.
struct PacketPoints {
  AngleBall ball;
  alignas(64) float at[3][kPacket] = {};

  PacketPoints(const UnitFrame& frame, std::span<const Vec3> points) {
    Box box;
    for (const Vec3& p : points) extend(box, frame.to_unit(p));
    ball = {0.5 * (box.lower + box.upper), 0};
    double radius = 0;
    for (std::size_t i = 0; i < kPacket; ++i) {
      const Vec3 offset = frame.to_unit(points[std::min(i, points.size() - 1)]) - ball.centre;
      radius = std::max(radius, norm(offset));
      for (int k = 0; k < 3; ++k) at[k][i] = static_cast<float>(offset[k]);
    }
    ball = {ball.centre, radius};
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
using PointVec3 = lanes::HWY_NAMESPACE::Vec3Of<PointVec>;

void gather_faces(const SolidAngles& angles, const PacketPoints& points, std::span<const std::uint32_t> near,
                  std::vector<PacketFace>& faces) {
  faces.clear();
  for (const std::uint32_t index : near) {
    PacketFace& face = faces.emplace_back();
    double farthest = 0;
    const std::array<Vec3, 3> corners = angles.faces.corners(index);
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 corner = angles.faces.faces.frame.to_unit(corners[j]) - points.ball.centre;
      farthest = std::max(farthest, std::abs(corner[0]) + std::abs(corner[1]) + std::abs(corner[2]));
      for (int k = 0; k < 3; ++k) face.corner[j][k] = static_cast<float>(corner[k]);
    }
    face.displacement = static_cast<float>(1.01 * (kHalfUlpF * farthest + points.ball.displacement));
  }
}

template <class Mask>
HWY_INLINE std::uint32_t bits_of(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(PointFloats(), mask, bytes);
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8;
}

// Sums of solid angles, one per lane, as SolidAngleSum has them.
//
// With a, b, c the corners relative to a point, L = |a||b||c|, and z the complex number of half_solid_angle()
// over L. By u = 2⁻²⁴, z is rounded by less than 128·u. A displacement of each corner by η changes the
// numerator by at most √17·η·(|b||c| + |a||c| + |a||b|)·(1 + η/l)², where l is the least length, so z by less
// than 8·η·(1/|a| + 1/|b| + 1/|c|), unless η > 0.39·l: then eight times this bound exceeds |z| ≤ √17, and the
// angle counts as unknown. Lengths whose product underflows make the bound infinite or no number, and the
// angle unknown.
class NearSum {
 public:
  NearSum() {
    const PointFloats d;
    real_ = hn::Set(d, 1);
    imaginary_ = turns_ = error_ = hn::Zero(d);
  }

  // The corners relative to the points; `eta` displaces them. Adds the angles that single precision decides,
  // and returns the bits of the others, where points are beside the face.
  HWY_INLINE std::uint32_t add(const PointVec3& a, const PointVec3& b, const PointVec3& c, PointVec eta) {
    using lanes::HWY_NAMESPACE::cross, lanes::HWY_NAMESPACE::dot;
    const PointFloats d;
    const auto la = hn::Sqrt(dot(a, a)), lb = hn::Sqrt(dot(b, b)), lc = hn::Sqrt(dot(c, c));
    const auto bc = hn::Mul(lb, lc), one = hn::Set(d, 1), inverse = hn::Div(one, hn::Mul(la, bc));
    const auto lengths = hn::MulAdd(la, hn::Add(lb, lc), bc);
    const auto dots = hn::MulAdd(dot(a, b), lc, hn::MulAdd(dot(b, c), la, hn::Mul(dot(c, a), lb)));
    const auto real = hn::MulAdd(dots, inverse, one), imaginary = hn::Mul(dot(a, cross(b, c)), inverse);
    const auto bound =
        hn::MulAdd(hn::Mul(hn::Set(d, 8), eta), hn::Mul(lengths, inverse), hn::Set(d, 128 * 0x1p-24F));
    return multiply(real, imaginary, bound);
  }
  // The sum, to within 0.01 and error().
  PointVec sum() const {
    const PointFloats d;
    const float whole = static_cast<float>(4 * std::numbers::pi);
    return hn::MulAdd(hn::Set(d, whole), turns_, hn::Mul(hn::Set(d, 2), argument()));
  }
  PointVec error() const { return error_; }

 private:
  HWY_INLINE std::uint32_t multiply(PointVec real, PointVec imaginary, PointVec bound) {
    const PointFloats d;
    const auto zero = hn::Zero(d);
    auto squared = hn::MulAdd(real, real, hn::Mul(imaginary, imaginary));
    const auto either_side = hn::And(hn::Le(real, bound), hn::Le(hn::Abs(imaginary), bound));
    auto eight = hn::Mul(hn::Set(d, 8), bound);
    const auto known = hn::AndNot(either_side, hn::Gt(squared, hn::Mul(eight, eight)));
    std::uint32_t unknown = 0;
    if (!hn::AllTrue(d, known)) {
      unknown = bits_of(hn::Not(known));
      const auto one = hn::Set(d, 1);
      squared = hn::IfThenElse(known, squared, one);
      real = hn::IfThenElse(known, real, one);
      imaginary = hn::IfThenElseZero(known, imaginary);
      eight = hn::IfThenElseZero(known, eight);
    }
    // An estimate: the product may have any size near 1, and the bound has a tenth to spare.
    const auto inverse = hn::ApproximateReciprocalSqrt(squared);
    const auto turned = hn::MulAdd(eight, inverse, hn::Set(d, 16 * 0x1p-24F));
    error_ = hn::Add(error_, turned);
    const auto re = hn::Mul(real, inverse), im = hn::Mul(imaginary, inverse);
    const auto next_real = hn::MulSub(real_, re, hn::Mul(imaginary_, im));
    const auto next = hn::MulAdd(real_, im, hn::Mul(imaginary_, re));
    const auto up = hn::Ge(imaginary_, zero), factor_up = hn::Ge(im, zero), next_up = hn::Ge(next, zero);
    const auto more = hn::AndNot(next_up, hn::And(up, factor_up));
    const auto fewer = hn::AndNot(hn::Or(up, factor_up), next_up);
    turns_ = hn::Add(turns_, hn::IfThenElseZero(more, hn::Set(d, 1)));
    turns_ = hn::Sub(turns_, hn::IfThenElseZero(fewer, hn::Set(d, 1)));
    real_ = next_real;
    imaginary_ = next;
    return unknown;
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

// The angles of faces beside points, which single precision does not decide.
class BesideFaces {
 public:
  BesideFaces(const SolidAngles& angles, std::span<const std::uint32_t> faces)
      : angles_(angles), faces_(faces) {
    open_.clear();
  }

  // Adds the face in this place, for these points.
  void add(std::size_t place, std::uint32_t points) { open_.push_back({faces_[place], points}); }
  [[nodiscard]] bool empty() const { return open_.empty(); }
  // Their sum at a point, in double precision.
  [[nodiscard]] SolidAngle at(const Vec3& q, std::uint32_t bit) const {
    SolidAngleSum sum;
    for (const Open& open : open_) {
      if ((open.points & bit) == 0) continue;
      const auto [a, b, c] = angles_.faces.corners(open.face);
      sum.add(half_solid_angle(a - q, b - q, c - q));
    }
    return sum.sum();
  }

 private:
  struct Open {
    std::uint32_t face, points;
  };
  static std::vector<Open>& memory() {
    thread_local std::vector<Open> open;
    return open;
  }

  const SolidAngles& angles_;
  std::span<const std::uint32_t> faces_;
  std::vector<Open>& open_ = memory();
};

// The sums of both for one point, with a face per lane.
PacketSides compare(const FarField& far, std::span<const PacketFace> faces, BesideFaces& beside,
                    const float (&point)[3], const Vec3& q, double limit) {
  const PointFloats d;
  const std::size_t width = hn::Lanes(d);
  // All corners in one point make no angle.
  static constexpr PacketFace kNothing{{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, 0};
  alignas(64) float corner[3][3][kPacket], displacement[kPacket];
  const PointVec3 at_q = lanes::HWY_NAMESPACE::splat(d, point);
  NearSum near;
  for (std::size_t first = 0; first < faces.size(); first += width) {
    for (std::size_t i = 0; i < width; ++i) {
      const PacketFace& face = first + i < faces.size() ? faces[first + i] : kNothing;
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) corner[j][k][i] = face.corner[j][k];
      displacement[i] = face.displacement;
    }
    const auto at = [&](int j) HWY_ATTR { return sub(lanes::HWY_NAMESPACE::load(d, corner[j], 0), at_q); };
    std::uint32_t open = near.add(at(0), at(1), at(2), hn::Load(d, displacement));
    for (; open != 0; open &= open - 1) {
      const std::size_t place = first + static_cast<std::size_t>(std::countr_zero(open));
      if (place < faces.size()) beside.add(place, 1);
    }
  }
  const auto total_of = [&](PointVec v) HWY_ATTR { return double{hn::GetLane(hn::SumOfLanes(d, v))}; };
  const SolidAngle exact = beside.at(q, 1);
  const double from_limit = far.value - limit, total = from_limit + exact.value + total_of(near.sum());
  const double size = std::abs(from_limit) + std::abs(exact.value) + total_of(hn::Abs(near.sum()));
  // The argument of each lane is approximate, and the rest rounded in few steps.
  const double error = 1.001 * (far.error + exact.error + total_of(near.error())) +
                       0.01 * static_cast<double>(width) + 1e-5 * size;
  return {std::abs(total) > error ? 1u : 0u, total > error ? 1u : 0u};
}

// The sums of both, compared with the limits.
PacketSides compare(const FarField& far, std::span<const PacketFace> faces, BesideFaces& beside,
                    const PacketPoints& points, std::span<const Vec3> exact_points,
                    std::span<const double> limits) {
  const PointFloats d;
  alignas(64) float from_limit[kPacket] = {};
  for (std::size_t i = 0; i < limits.size(); ++i) from_limit[i] = static_cast<float>(far.value - limits[i]);
  PacketSides sides;
  alignas(64) float total_at[kPacket], error_at[kPacket];
  for (size_t i = 0; i < limits.size(); i += hn::Lanes(d)) {
    const auto x = hn::Load(d, points.at[0] + i), y = hn::Load(d, points.at[1] + i),
               z = hn::Load(d, points.at[2] + i);
    NearSum near;
    const PointVec3 q{x, y, z};
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const PacketFace& face = faces[f];
      const auto at = [&](int j) HWY_ATTR { return sub(lanes::HWY_NAMESPACE::splat(d, face.corner[j]), q); };
      const std::uint32_t open = near.add(at(0), at(1), at(2), hn::Set(d, face.displacement));
      if (open != 0) beside.add(f, open << i);
    }
    const auto slope = [&](int k) HWY_ATTR { return hn::Set(d, static_cast<float>(far.gradient[k])); };
    const auto linear = hn::MulAdd(slope(0), x, hn::MulAdd(slope(1), y, hn::Mul(slope(2), z)));
    const auto start = hn::Load(d, from_limit + i), angle = near.sum();
    const auto total = hn::Add(hn::Add(start, linear), angle);
    // The argument is approximate, and the rest rounded in few steps.
    const auto size = hn::Add(hn::Add(hn::Abs(start), hn::Abs(angle)), hn::Abs(linear));
    const auto error = hn::Add(hn::MulAdd(hn::Set(d, 1e-5F), size, near.error()),
                               hn::Set(d, static_cast<float>(1.001 * far.error + 0.01)));
    hn::Store(total, d, total_at + i);
    hn::Store(error, d, error_at + i);
  }
  for (std::size_t i = 0; i < limits.size(); ++i) {
    double total = total_at[i], error = error_at[i];
    if (!beside.empty()) {
      const SolidAngle exact = beside.at(exact_points[i], 1u << i);
      total += exact.value;
      error += exact.error;
    }
    sides.known |= (std::abs(total) > error ? 1u : 0u) << i;
    sides.above |= (total > error ? 1u : 0u) << i;
  }
  return sides;
}

}  // namespace

PacketSides SidesOfPacket(const SolidAngles& angles, std::span<const Vec3> points,
                          std::span<const double> limits) {
  const PacketPoints packet(angles.faces.faces.frame, points);
  if (!packet.ball.in_range()) return {};
  thread_local std::vector<std::uint32_t> near;
  thread_local std::vector<PacketFace> faces;
  thread_local LearnedLimits learned;
  const bool one = points.size() == 1;
  FarField field;
  for (const bool last : {one, true}) {
    poll();
    FarSum far(angles, packet.ball, false, one ? kLimitsOfPoint : learned.of(angles.number), near);
    if (!far.collect()) return {};
    field = far.sum();
    if (last || learned.learn(field.error)) break;
  }
  gather_faces(angles, packet, near, faces);
  BesideFaces beside(angles, near);
  if (!one) return compare(field, faces, beside, packet, points, limits);
  const float at[3] = {packet.at[0][0], packet.at[1][0], packet.at[2][0]};
  return compare(field, faces, beside, at, points[0], limits[0]);
}

PacketSides SideOfBall(const SolidAngles& angles, const Vec3& centre, double radius, double limit) {
  const UnitFrame& frame = angles.faces.faces.frame;
  const AngleBall ball(frame.to_unit(centre), (1 + 1e-6) * radius * frame.scale);
  if (!ball.in_range()) return {};
  thread_local std::vector<std::uint32_t> near;
  poll();
  FarSum far(angles, ball, true, kLimitsOfBall, near);
  if (!far.collect()) return {};
  const FarField field = far.sum();
  const Vec3 gradient{field.gradient[0], field.gradient[1], field.gradient[2]};
  const double from_limit = field.value - limit, change = ball.radius * norm(gradient);
  const double error = 1.001 * field.error + change + 1e-5 * (std::abs(from_limit) + change);
  return {std::abs(from_limit) > error ? 1u : 0u, from_limit > error ? 1u : 0u};
}

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::inside {

HWY_EXPORT(SidesOfPacket);
HWY_EXPORT(SideOfBall);

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

PacketSides side_of_ball(const SolidAngles& angles, const Vec3& centre, double radius, double limit) {
  if (angles.empty()) return {1, limit < 0 ? 1u : 0u};
  return HWY_DYNAMIC_DISPATCH(SideOfBall)(angles, centre, radius, limit);
}

}  // namespace sdm::inside
#endif
