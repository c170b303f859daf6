#include "inside/angles/solid_angles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "inside/angles/solid_angles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "core/cancellation.h"
#include "core/lazy/unique_number.h"
#include "geometry/lanes/vec-inl.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "inside/angles/expansions-inl.h"

#ifndef SDM_SOLID_ANGLES_ONCE
#define SDM_SOLID_ANGLES_ONCE
namespace sdm::inside {
namespace {

// Terms with larger errors, in solid angle, are never part of a sum.
constexpr double kMostError = 0.3;
// The error is to become smaller than the distance from the limit by this factor: the rest is for the safe
// radius.
constexpr double kDecided = 1.2;
// Beyond this in the unit frame, single precision does not have the range for expansions.
constexpr double kFarthest = 0x1p20;

// The error of terms on the next pass. Where a surface is divided until the terms have the error e, their
// number is as 1/√e, and so is the sum of their errors as √e.
double next_error(double most, double wanted, double sum) {
  constexpr double kLeast = 1e-9;  // near rounding: then no term is left
  const double factor = wanted / sum;
  const double next = most * std::clamp(factor * factor, 1.0 / 64, 0.5);
  return next < kLeast ? 0 : next;
}

// No face is seen from a point at this distance from the origin under more than A / g².
SolidAngle far_away(const SolidAngles& angles, double from_origin) {
  double area = 0;
  for (const float of_child : angles.expansions.nodes[0].area) area += of_child;
  const double gap = from_origin - 2;
  return {0, area / (gap * gap)};
}

// The expansions that are part of a sum: child `place` % 8 of node `place` / 8 of the wide tree.
struct ExpansionTerms {
  std::vector<float> value, error;
  std::vector<float> gap;        // between q and its faces
  std::vector<float> steepness;  // A / gap³
  std::vector<std::uint32_t> place;
  std::size_t count = 0;
  std::vector<std::uint32_t> open;  // places of children that are not part of it

  void clear() {
    count = 0;
    open.clear();
  }
  // Makes room for some more, and for what vectors write beyond those.
  void reserve(std::size_t more) {
    if (count + more <= place.size()) return;
    const std::size_t size = 2 * (count + more);
    for (auto* floats : {&value, &error, &gap, &steepness}) floats->resize(size);
    place.resize(size);
  }
  // Sets what vectors read beyond the last one.
  void end_with_zeros() {
    reserve(Expansions::kWidth);
    for (std::size_t i = count; i < count + Expansions::kWidth; ++i) value[i] = error[i] = 0;
  }
  // Opens those with larger errors.
  void open_above(double most) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (error[i] > most) {
        open.push_back(place[i]);
        continue;
      }
      value[kept] = value[i];
      error[kept] = error[i];
      gap[kept] = gap[i];
      steepness[kept] = steepness[i];
      place[kept++] = place[i];
    }
    count = kept;
  }
};

}  // namespace
}  // namespace sdm::inside
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::inside::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

constexpr size_t kWidth = Expansions::kWidth;
using Floats = ChildFloats;

// The sum at one point while it is refined.
class Refinement {
 public:
  // Uses the memory of `terms`.
  Refinement(const SolidAngles& angles, const Vec3& q, ExpansionTerms& terms)
      : angles_(angles), tree_(angles.faces.faces), q_(q), unit_(tree_.frame.to_unit(q)), terms_(terms) {
    for (int k = 0; k < 3; ++k) {
      high_[k] = static_cast<float>(unit_[k]);
      low_[k] = static_cast<float>(unit_[k] - high_[k]);
    }
    displacement_ = static_cast<float>((1 + 1e-6) * Expansions::kDisplacement * (1 + norm(unit_)));
    terms_.clear();
  }

  // Starts with terms whose errors are at most `most`.
  void start(double most) {
    most_ = static_cast<float>(most);
    expand(0);
    open_all();
  }
  // Replaces terms with larger errors by those of their parts, or by faces.
  void refine(double most) {
    most_ = static_cast<float>(most);
    terms_.open_above(most_);
    open_all();
  }
  bool by_faces() const { return terms_.count == 0; }

  SolidAngle sum() const {
    using D = hn::CappedTag<double, kWidth>;
    const D d;
    const hn::Rebind<float, D> df;
    auto value = hn::Zero(d), error = hn::Zero(d), magnitude = hn::Zero(d);
    terms_.end_with_zeros();
    for (size_t i = 0; i < terms_.count; i += hn::Lanes(d)) {
      const auto v = hn::PromoteTo(d, hn::LoadU(df, terms_.value.data() + i));
      value = hn::Add(value, v);
      magnitude = hn::Add(magnitude, hn::Abs(v));
      error = hn::Add(error, hn::PromoteTo(d, hn::LoadU(df, terms_.error.data() + i)));
    }
    const SolidAngle faces = faces_.sum();
    // The bounds are rounded in single precision, in few steps.
    constexpr double kBounds = 1 + 1e-5;
    const double rounding = kHalfUlp * static_cast<double>(terms_.count + 8);
    return {faces.value + hn::GetLane(hn::SumOfLanes(d, value)),
            faces.error + kBounds * hn::GetLane(hn::SumOfLanes(d, error)) +
                2 * rounding * (hn::GetLane(hn::SumOfLanes(d, magnitude)) + std::abs(faces.value))};
  }
  // How far q can move while the sum changes by less than `change`. No term changes by more than 2·A/g³ per
  // length, where g is the distance to its faces on the way, at least 3/4 of that from q.
  double safe_radius(double change) const {
    double nearest = nearest_leaf_, steepest = steepness_of_leaves_;
    for (size_t i = 0; i < terms_.count; ++i) {
      nearest = std::min(nearest, double{terms_.gap[i]});
      steepest += terms_.steepness[i];
    }
    return (1 - 1e-5) * std::min(0.25 * nearest, change * (27.0 / 64) / (2 * steepest)) / tree_.frame.scale;
  }

 private:
  void open_all() {
    Poll due(256);
    while (!terms_.open.empty()) {
      due();
      const uint32_t place = terms_.open.back();
      terms_.open.pop_back();
      const uint32_t child = angles_.wide.nodes[place / kWidth].child[place % kWidth];
      if (tree::WideTree::is_leaf(child))
        add_faces(place);
      else
        expand(child);
    }
  }

  // Adds the expansions of a node's children, and opens those whose errors would be large.
  void expand(uint32_t index) {
    const Expansions& e = angles_.expansions.nodes[index];
    const uint32_t children = angles_.wide.nodes[index].count;
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const auto most = hn::Set(d, most_), displacement = hn::Set(d, displacement_);
    terms_.reserve(2 * kWidth);
    for (size_t i = 0; i < children; i += hn::Lanes(d)) {
      hn::Vec<Floats> r[3];
      for (int k = 0; k < 3; ++k)
        r[k] = hn::Sub(hn::Sub(hn::Load(d, e.centre[k] + i), hn::Set(d, high_[k])), hn::Set(d, low_[k]));
      const auto squared = dot(r, r), distance = hn::Sqrt(squared);
      const auto radius = hn::Load(d, e.radius + i), area = hn::Load(d, e.area + i);
      const auto gap = hn::MulSub(distance, hn::Set(d, 1 - 16 * 0x1p-24F), hn::Add(radius, displacement));
      const auto inverse_gap = hn::Div(hn::Set(d, 1), gap), by_gap2 = hn::Mul(inverse_gap, inverse_gap);
      const auto inverse = hn::Div(hn::Set(d, 1), hn::Mul(squared, distance));
      const auto steepness = hn::Mul(area, hn::Mul(inverse_gap, by_gap2));
      const auto size = hn::NegMulAdd(hn::Set(d, 2), radius, hn::Mul(hn::Set(d, 3), distance));
      const auto second = hn::Mul(hn::Load(d, e.second + i), hn::Mul(size, inverse));
      const auto error = hn::MulAdd(hn::Add(second, hn::Load(d, e.noise + i)), by_gap2,
                                    hn::Mul(hn::Add(displacement, displacement), steepness));
      auto part = hn::And(hn::Gt(gap, hn::Zero(d)), hn::Le(error, most));
      part = hn::And(part, hn::FirstN(d, children - i));
      add_terms(part, expansion_value(e, i, r, squared, inverse), error, gap, steepness,
                hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<uint32_t>(index * kWidth + i))));
      open_others(i, part, children, index);
    }
  }
  template <class V, class Mask, class Places>
  HWY_INLINE void add_terms(Mask part, V value, V error, V gap, V steepness, Places places) {
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const size_t at = terms_.count;
    // The masked stores of CompressStore() take far longer on some processors.
    hn::StoreU(hn::Compress(value, part), d, terms_.value.data() + at);
    hn::StoreU(hn::Compress(error, part), d, terms_.error.data() + at);
    hn::StoreU(hn::Compress(gap, part), d, terms_.gap.data() + at);
    hn::StoreU(hn::Compress(steepness, part), d, terms_.steepness.data() + at);
    hn::StoreU(hn::Compress(places, hn::RebindMask(du, part)), du, terms_.place.data() + at);
    terms_.count += hn::CountTrue(d, part);
  }
  template <class Mask>
  void open_others(size_t i, Mask part, uint32_t children, uint32_t index) {
    const Floats d;
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, part, bytes);
    const auto lanes = static_cast<uint32_t>(std::min<size_t>(hn::Lanes(d), children - i));
    uint32_t others = ~uint32_t{bytes[0]} & ((1u << lanes) - 1);
    for (; others != 0; others &= others - 1)
      terms_.open.push_back(static_cast<uint32_t>(index * kWidth + i) +
                            static_cast<uint32_t>(std::countr_zero(others)));
  }

  // Adds the faces of a leaf.
  void add_faces(uint32_t place) {
    const uint32_t leaf = angles_.wide.nodes[place / kWidth].source[place % kWidth];
    const std::span<const uint32_t> items = tree_.tree.items_of(leaf);
    for (size_t first = 0; first < items.size(); first += kLanes)
      add_faces(items.subspan(first, std::min(kLanes, items.size() - first)));
    const double gap = norm(tree::gap(tree_.tree.box(leaf), unit_));
    const double area = angles_.expansions.nodes[place / kWidth].area[place % kWidth];
    nearest_leaf_ = std::min(nearest_leaf_, gap);
    steepness_of_leaves_ += gap > 0 ? area / (gap * gap * gap) : kInfinity;
  }
  // Adds at most as many faces as there are lanes, as half_solid_angle() does.
  void add_faces(std::span<const uint32_t> items) {
    Vec3Lanes corners[3];
    for (size_t j = 0; j < items.size(); ++j) {
      const std::array<Vec3, 3> at = angles_.faces.corners(items[j]);
      for (int k = 0; k < 3; ++k) corners[k].set(j, at[static_cast<size_t>(k)] - q_);
    }
    const Doubles d;
    alignas(64) double real[kLanes], imaginary[kLanes], distance[kLanes], error[kLanes];
    for (size_t i = 0; i < items.size(); i += hn::Lanes(d)) {
      const Vec3v a = corners[0].load(i), b = corners[1].load(i), c = corners[2].load(i);
      const Vec la = hn::Sqrt(dot(a, a)), lb = hn::Sqrt(dot(b, b)), lc = hn::Sqrt(dot(c, c));
      const Vec product = hn::Mul(hn::Mul(la, lb), lc), im = dot(a, cross(b, c));
      const Vec re = hn::MulAdd(dot(a, b), lc, hn::MulAdd(dot(b, c), la, hn::MulAdd(dot(c, a), lb, product)));
      const Vec bound = hn::Mul(hn::Set(d, 64 * kHalfUlp), product);
      const Vec length = hn::Sqrt(hn::MulAdd(im, im, hn::Mul(re, re)));
      const auto either_side = hn::And(hn::Le(re, bound), hn::Le(hn::Abs(im), bound));
      const Vec eight = hn::Mul(hn::Set(d, 8), bound);
      const auto known = hn::AndNot(either_side, hn::Gt(length, eight));
      hn::Store(re, d, real + i);
      hn::Store(im, d, imaginary + i);
      hn::Store(length, d, distance + i);
      hn::Store(hn::IfThenElse(known, hn::Div(eight, length), hn::Inf(d)), d, error + i);
    }
    for (size_t j = 0; j < items.size(); ++j) faces_.add({real[j], imaginary[j], distance[j], error[j]});
  }

  const SolidAngles& angles_;
  const FaceTree& tree_;
  const Vec3& q_;
  Vec3 unit_;               // q in the unit frame
  float high_[3], low_[3];  // its two parts
  float displacement_;      // δ
  float most_ = 0;
  ExpansionTerms& terms_;
  SolidAngleSum faces_;
  double nearest_leaf_ = kInfinity, steepness_of_leaves_ = 0;
};

}  // namespace

SolidAngles::Sum SumAt(const SolidAngles& angles, const Vec3& q, double limit, double tolerance) {
  const double from_origin = norm(angles.faces.faces.frame.to_unit(q));
  double most = kMostError;
  if (!(from_origin < kFarthest)) {
    const SolidAngle angle = far_away(angles, from_origin);
    if (std::abs(limit) > angle.error || angle.error <= tolerance) return {angle, 0};
    most = 0;
  }
  thread_local ExpansionTerms terms;
  Refinement refinement(angles, q, terms);
  for (refinement.start(most);; refinement.refine(most)) {
    poll();
    const SolidAngle angle = refinement.sum();
    const double from_limit = std::abs(angle.value - limit);
    if (from_limit > kDecided * angle.error || angle.error <= tolerance || std::isinf(angle.error) ||
        refinement.by_faces()) {
      const double change = from_limit - angle.error;
      return {angle, change > 0 ? refinement.safe_radius(change) : 0};
    }
    most = next_error(most, std::max(tolerance, from_limit / kDecided), angle.error);
  }
}

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::inside {

HWY_EXPORT(SumAt);

SolidAngles::SolidAngles(const OrientedFaces& all, const tree::WideTree& collapsed)
    : number(unique_number()), faces(all), wide(collapsed), expansions(expansions_of(all, collapsed)) {}

SolidAngles::Sum SolidAngles::at(const Vec3& q, double limit, double tolerance) const {
  if (empty()) return {{}, kInfinity};
  return HWY_DYNAMIC_DISPATCH(SumAt)(*this, q, limit, tolerance);
}

}  // namespace sdm::inside
#endif
