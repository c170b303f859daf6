#include "bodies/motion/safe_time.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdm::motion {
namespace {

constexpr double kForever = kInfinity;

// A bound on u·x for a point x of a part, s after now: at + speed s + bend s² / 2.
struct Rise {
  double at = 0, speed = 0, bend = 0;
};

// Three bounds, each for all s, of each point of a part; the motion of the centre is left out. For a point q
// that turns about the axis w by an angle of θ s, and is ρ from the axis, with Q(s) its place,
//   d/ds u·Q = θ u·(w × Q) = θ (u × w)·Q,   |d/ds u·Q| ≤ θ |u × w| ρ,   |d²/ds² u·Q| ≤ θ² |u × w| ρ,
// since u × w is perpendicular to w, and turning keeps the distance from the axis and the height along it.
// The first is the bound on the motion along a direction of Tang, Kim & Manocha, C²A: Controlled Conservative
// Advancement for Continuous Collision Detection of Polygonal Models, ICRA 2009.
class Rises {
 public:
  enum Bound { speed, taylor, circle, kBounds };

  Rises(const Part& part, const DividedMotion& motion, const std::array<Vec3, 3>& linear, const Vec3& u)
      : part_(part), motion_(motion), linear_(linear), u_(u) {
    find(in_mesh(u), at_);
  }

  // u·x now.
  [[nodiscard]] double at(std::size_t i) const { return at_[i]; }
  [[nodiscard]] double most() const {
    return part_.points == 1 ? at_[0] : std::max({at_[0], at_[1], at_[2]});
  }

  void bound(Bound bound, std::array<Rise, 3>& rise) {
    if (!motion_.turns()) {
      for (std::size_t i = 0; i < part_.points; ++i) rise[i] = {.at = at_[i]};
      return;
    }
    const double angle = motion_.angle();
    if (bound == speed) {
      side_ = cross(u_, motion_.axis());
      across_ = norm(side_);
    }
    std::array<double, 3> extent{};
    if (bound == taylor) find(in_mesh(angle * side_), extent);
    if (bound == circle) find((dot(u_, motion_.axis()) * motion_.scale()) * motion_.mesh_axis(), extent);
    for (std::size_t i = 0; i < part_.points; ++i) {
      const double swing = across_ * part_.radius[i];
      if (bound == speed) rise[i] = {.at = at_[i], .speed = angle * swing};
      if (bound == taylor) rise[i] = {.at = at_[i], .speed = extent[i], .bend = angle * angle * swing};
      if (bound == circle) rise[i] = {.at = std::min(extent[i] + swing, part_.from_middle)};
    }
  }

 private:
  [[nodiscard]] Vec3 in_mesh(const Vec3& v) const {
    return v[0] * linear_[0] + v[1] * linear_[1] + v[2] * linear_[2];
  }
  // The largest v·p of the box, or v·p of each corner.
  void find(const Vec3& v, std::array<double, 3>& extent) const {
    for (std::size_t i = 0; i < part_.points; ++i) extent[i] = dot(v, part_.point[i]);
    if (part_.points == 1)
      for (int k = 0; k < 3; ++k) extent[0] += std::abs(dot(v, part_.axis[k])) * part_.half[k];
  }

  const Part& part_;
  const DividedMotion& motion_;
  const std::array<Vec3, 3>& linear_;
  const Vec3 u_;
  std::array<double, 3> at_{};
  Vec3 side_{};
  double across_ = 0;
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
  return body == 0 ? turned(0, p) : turned(1, p) + between_;
}

Vec3 SafeTime::turned(int body, const Vec3& direction) const {
  return Affine{.rows = linear_[body]}.linear(direction);
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
  Rises rises1(part1, *motions_[0], linear_[0], u), rises2(part2, *motions_[1], linear_[1], -u);
  if (!(apart - rises1.most() - rises2.most() > 0)) return now_;
  const bool turning = motions_[0]->turns() || motions_[1]->turns();
  const double rest = kAbove * (1 - now_);
  double longest = 0;
  std::array<Rise, 3> rise1, rise2;
  for (const auto bound : {Rises::speed, Rises::taylor, Rises::circle}) {
    rises1.bound(bound, rise1);
    rises2.bound(bound, rise2);
    // All pairs of points stay apart: then so do their hulls.
    double safe = rest;
    for (std::size_t i = 0; i < part1.points; ++i)
      for (std::size_t j = 0; j < part2.points; ++j) {
        const Rise &a = rise1[i], &b = rise2[j];
        const double gap = apart - a.at - b.at, speed = closing + a.speed + b.speed, bend = a.bend + b.bend;
        if (gap > 0 && gap - safe * (speed + 0.5 * safe * bend) > 0) continue;  // concave: so is all between
        safe = std::min(safe, time_to_close(gap, speed, bend));
      }
    longest = std::max(longest, safe);
    if (longest >= rest) return kForever;
    if (!turning) break;
  }
  // Rounded down; of less than one unit of the time, nothing is left.
  return std::max(now_, std::nextafter(now_ + longest / kAbove, 0.0));
}

}  // namespace sdm::motion
