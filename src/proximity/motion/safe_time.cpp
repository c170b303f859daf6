#include "proximity/motion/safe_time.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdm::motion {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

// A bound on u·x for a point x of a part, s after now: at + speed s + bend s² / 2.
struct Rise {
  double at = 0, speed = 0, bend = 0;
};

// Three bounds, each for all s, of each point of a part; the motion of the centre is left out. For a point q
// that turns about the axis w by an angle of θ s, and is ρ from the axis, with Q(s) its place,
//   d/ds u·Q = θ u·(w × Q) = θ (u × w)·Q,   |d/ds u·Q| ≤ θ |u × w| ρ,   |d²/ds² u·Q| ≤ θ² |u × w| ρ,
// since u × w is perpendicular to w and both the distance from the axis and the height along it are kept.
// The first is the bound on the motion along a direction of Tang, Kim & Manocha, C²A: Controlled Conservative
// Advancement for Continuous Collision Detection of Polygonal Models, ICRA 2009.
struct Rises {
  enum Bound { speed, taylor, circle, kBounds };
  std::array<std::array<Rise, 3>, kBounds> of;

  Rises(const Part& part, const DividedMotion& motion, const std::array<Vec3, 3>& linear, const Vec3& u) {
    const auto in_mesh = [&](const Vec3& v) {
      return v[0] * linear[0] + v[1] * linear[1] + v[2] * linear[2];
    };
    const auto support = [&](const Vec3& v, const Vec3& p) {
      return dot(v, p) + std::abs(v[0]) * part.half[0] + std::abs(v[1]) * part.half[1] +
             std::abs(v[2]) * part.half[2];
    };
    const Vec3 along = in_mesh(u);
    if (!motion.turns()) {
      for (std::size_t i = 0; i < part.points; ++i)
        of[speed][i] = of[taylor][i] = of[circle][i] = {.at = support(along, part.point[i])};
      return;
    }
    const Vec3 side = cross(u, motion.axis());
    const double angle = motion.angle(), across = norm(side);
    const Vec3 turning = in_mesh(angle * side);
    const Vec3 on_axis = (dot(u, motion.axis()) * motion.scale()) * motion.mesh_axis();
    for (std::size_t i = 0; i < part.points; ++i) {
      const double at = support(along, part.point[i]), swing = across * part.radius[i];
      of[speed][i] = {.at = at, .speed = angle * swing};
      of[taylor][i] = {.at = at, .speed = support(turning, part.point[i]), .bend = angle * angle * swing};
      of[circle][i] = {.at = support(on_axis, part.point[i]) + swing};
    }
  }
};

// The largest s with gap − speed s − bend s² / 2 ≥ 0 from 0 to s, as far as it is less than 1: the polynomial
// is concave. 0 where an operand is not a number.
double time_to_close(double gap, double speed, double bend) {
  if (!(gap > 0)) return 0;
  if (bend == 0 && speed <= 0) return kForever;
  const double root = std::sqrt(speed * speed + 2 * bend * gap);
  if (speed == 0 && root == 0) return gap >= bend ? kForever : 0;  // bend × gap underflows
  const double s = speed >= 0 ? 2 * gap / (speed + root) : (root - speed) / bend;
  return s >= 0 ? s : 0;
}

}  // namespace

SafeTime::SafeTime(const DividedMotion& motion1, const DividedMotion& motion2, double reserve)
    : motions_{&motion1, &motion2},
      reserve_(reserve),
      rounding_(motion1.rounding() + motion2.rounding()),
      closing_(motion1.shift() - motion2.shift()) {
  set_now(0);
}

void SafeTime::set_now(double time) {
  now_ = time;
  for (int body = 0; body < 2; ++body) linear_[body] = motions_[body]->linear_at(time);
  between_ = motions_[1]->start() - motions_[0]->start() - time * closing_;
}

Vec3 SafeTime::place(int body, const Vec3& p) const {
  const Affine turned{.rows = linear_[body]};
  return body == 0 ? turned.linear(p) : turned.linear(p) + between_;
}

Vec3 SafeTime::axis_of(int body, int k) const {
  return {linear_[body][0][k], linear_[body][1][k], linear_[body][2][k]};
}

Vec3 SafeTime::velocity(const Vec3& point1, const Vec3& point2) const {
  const auto turning = [&](int body, const Vec3& q) {
    return motions_[body]->angle() * cross(motions_[body]->axis(), q);
  };
  return turning(1, point2 - between_) - turning(0, point1) - closing_;
}

double SafeTime::until(const Part& part1, const Part& part2, const Vec3& u) const {
  // The length of u, and a root, are rounded by a few units.
  constexpr double kAbove = 1 + 16 * std::numeric_limits<double>::epsilon();
  double reserve = kAbove * reserve_;
  for (int k = 0; k < 3; ++k) reserve += std::abs(u[k]) * rounding_[k];
  const double apart = dot(u, between_) - reserve, closing = dot(u, closing_);
  const Rises rises1(part1, *motions_[0], linear_[0], u), rises2(part2, *motions_[1], linear_[1], -u);
  const bool turning = motions_[0]->turns() || motions_[1]->turns();
  double longest = 0;
  for (int bound = 0; bound < (turning ? Rises::kBounds : 1); ++bound) {
    // All pairs of points stay apart: then so do their hulls.
    double safe = kForever;
    for (std::size_t i = 0; i < part1.points && safe > longest; ++i)
      for (std::size_t j = 0; j < part2.points; ++j) {
        const Rise &a = rises1.of[bound][i], &b = rises2.of[bound][j];
        safe =
            std::min(safe, time_to_close(apart - a.at - b.at, closing + a.speed + b.speed, a.bend + b.bend));
      }
    longest = std::max(longest, safe);
  }
  if (longest > 1) return kForever;
  // Rounded down; of less than one unit of the time, nothing is left.
  return std::max(now_, std::nextafter(now_ + longest / kAbove, 0.0));
}

}  // namespace sdm::motion
