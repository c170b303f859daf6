// The smallest balls that touch a plane at a point and reach a triangle, several at a time. A source that
// includes this is compiled without contraction of products and sums, as closest_feature-inl.h. Included once
// for each set of vector instructions.
#if defined(SDM_TOUCHING_BALL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_TOUCHING_BALL_INL_H
#undef SDM_TOUCHING_BALL_INL_H
#else
#define SDM_TOUCHING_BALL_INL_H
#endif

#include "geometry/lanes/closest_feature-inl.h"
#include "geometry/triangle.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::thickness::HWY_NAMESPACE {
namespace {

using namespace lanes::HWY_NAMESPACE;

// The ball of radius r about p + r n touches the plane through p with the unit normal n at p, and reaches the
// point q at
//   r(q) = |q − p|² / (2 n·(q − p)),
// if q is above the plane; otherwise no ball does. A larger ball contains a smaller one.
//
// Of each of up to eight pairs of such balls and a closed triangle: the least radius at which one reaches the
// triangle, and where: the infimum over its points above the plane. 0 for a triangle that contains p and
// points above the plane. Exact to double rounding.
struct SmallestBalls {
  alignas(64) double p[3][kLanes], n[3][kLanes], corner[3][3][kLanes];
  alignas(64) double radius[kLanes], point[3][kLanes];  // the results

  void set(size_t lane, const Vec3& at, const Vec3& normal, const Corners& corners) {
    for (size_t k = 0; k < 3; ++k) {
      p[k][lane] = at[k];
      n[k][lane] = normal[k];
      for (size_t c = 0; c < 3; ++c) corner[c][k][lane] = corners[c][k];
    }
  }

  // Computes the first `count` lanes; the others must have been set to something before.
  void compute(size_t count) {
    const Doubles d;
    for (size_t i = 0; i < count; i += hn::Lanes(d)) compute_at(i);
  }

 private:
  struct Touched {
    Vec radius;
    Vec3v point;  // relative to p

    HWY_INLINE void offer(Vec r, const Vec3v& q) {
      const auto less = hn::Lt(r, radius);
      radius = hn::IfThenElse(less, r, radius);
      point = if_then_else(less, q, point);
    }
  };

  HWY_INLINE void compute_at(size_t i) {
    const Doubles d;
    const Vec zero = hn::Zero(d);
    const Vec3v from = load(d, p, i), normal = load(d, n, i);
    const Vec3v corners[3] = {sub(load(d, corner[0], i), from), sub(load(d, corner[1], i), from),
                              sub(load(d, corner[2], i), from)};
    Touched least{hn::Inf(d), {zero, zero, zero}};
    Vec highest = hn::Neg(hn::Inf(d));
    for (int k = 0; k < 3; ++k) {
      highest = hn::Max(highest, plain_dot(normal, corners[k]));
      reach_segment(normal, corners[k], corners[(k + 1) % 3], least);
    }
    reach_interior(normal, corners, least);
    const auto above = hn::Gt(highest, zero);
    hn::Store(hn::IfThenElse(above, least.radius, hn::Inf(d)), d, radius + i);
    hn::Store(hn::Add(least.point.x, from.x), d, point[0] + i);
    hn::Store(hn::Add(least.point.y, from.y), d, point[1] + i);
    hn::Store(hn::Add(least.point.z, from.z), d, point[2] + i);
  }

  // The radius on a line a + s d, with α = n·a and β = n·d, is convex where w = α + β s > 0, with its minimum
  // at
  //   D β s² + 2 D α s + 2 (a·d) α − β |a|² = 0,  D = |d|²,
  // whose discriminant is D |β a − α d|²: w = |β a − α d| / √D there. Of the two forms of the root, each sums
  // terms of the same sign only.
  HWY_INLINE static void reach_segment(const Vec3v& normal, const Vec3v& a, const Vec3v& b, Touched& least) {
    const Doubles d;
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1), two = hn::Set(d, 2);
    const Vec3v along = sub(b, a);
    const Vec alpha = plain_dot(normal, a), beta = plain_dot(normal, along);
    const Vec squared = plain_dot(along, along), size = plain_dot(a, a);
    const Vec3v turned = sub(mul(beta, a), mul(alpha, along));
    const Vec root = hn::Mul(hn::Sqrt(squared), hn::Sqrt(plain_dot(turned, turned)));
    const Vec below = hn::Add(hn::Mul(squared, alpha), root);
    const Vec down =
        hn::Div(hn::Sub(hn::Mul(beta, size), hn::Mul(hn::Mul(two, alpha), plain_dot(a, along))), below);
    const Vec up = hn::Div(hn::Sub(hn::Div(root, squared), alpha), beta);  // where β > −α ≥ 0
    const auto starts_above = hn::Gt(alpha, zero);
    const Vec free = hn::IfThenElse(starts_above, hn::IfThenElseZero(hn::Gt(below, zero), down), up);
    const Vec s = hn::IfThenElse(hn::Lt(free, zero), zero, hn::IfThenElse(hn::Lt(one, free), one, free));
    const Vec3v q{hn::Add(a.x, hn::Mul(s, along.x)), hn::Add(a.y, hn::Mul(s, along.y)),
                  hn::Add(a.z, hn::Mul(s, along.z))};
    const Vec height = plain_dot(normal, q), distance = plain_dot(q, q);
    // Relative, of a point that is p itself.
    constexpr double kRounding = 1e-15;
    const auto at_p = hn::Le(distance, hn::Mul(hn::Set(d, kRounding * kRounding), hn::Add(size, squared)));
    const Vec r = hn::IfThenElse(hn::Gt(height, zero), hn::Div(distance, hn::Mul(two, height)),
                                 hn::IfThenElse(at_p, zero, hn::Inf(d)));
    const auto ends_above = hn::Gt(hn::Add(alpha, beta), zero);
    least.offer(hn::IfThenElse(hn::Or(starts_above, ends_above), r, hn::Inf(d)), q);
  }

  // The plane m·q = h ≥ 0 is reached at q = r (n + m), where h = r (m·n + 1) = r |n + m|² / 2.
  HWY_INLINE static void reach_interior(const Vec3v& normal, const Vec3v (&corners)[3], Touched& least) {
    const Doubles d;
    const Vec zero = hn::Zero(d), two = hn::Set(d, 2);
    const auto& [a, b, c] = corners;
    const Vec3v crossed = plain_cross(sub(b, a), sub(c, a));
    const Vec size = hn::Sqrt(plain_dot(crossed, crossed));
    const Vec3v unit = mul(hn::Div(hn::Set(d, 1), size), crossed);
    const Vec signed_height = plain_dot(unit, a);
    const auto downward = hn::Lt(signed_height, zero);
    const Vec3v m = if_then_else(downward, neg(unit), unit);
    const Vec h = hn::IfThenElse(downward, hn::Neg(signed_height), signed_height);
    const Vec3v sum = add(normal, m);
    const Vec squared = plain_dot(sum, sum);
    const Vec r = hn::Div(hn::Mul(two, h), squared);
    const Vec3v q = mul(r, sum);
    const auto left_of = [&](const Vec3v& start, const Vec3v& end) HWY_ATTR {
      return hn::Ge(plain_dot(plain_cross(sub(end, start), sub(q, start)), unit), zero);
    };
    const auto within = hn::And(left_of(a, b), hn::And(left_of(b, c), left_of(c, a)));
    // NaN where the triangle has no area, or the ball touches its plane nowhere: such lanes are not within.
    least.offer(hn::IfThenElse(within, r, hn::Inf(d)), q);
  }
};

}  // namespace
}  // namespace sdm::thickness::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
