#include <sdm/error.h>
#include <sdm/proximity_query.h>
#include <sdm/time_of_contact.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mesh/similarity.h"
#include "proximity/shape/posed_body.h"

namespace sdm {
namespace {

using mesh::Similarity;

/// A motion, divided into that of the centre and a rotation about it.
class DividedMotion {
 public:
  DividedMotion(const Motion& motion, const Shape& shape)
      : from_(Similarity::of(motion.from)), to_(Similarity::of(motion.to)) {
    if (std::abs(to_.scale - from_.scale) > 1e-5 * from_.scale)
      throw Error("the scale of a body changes during its motion from " + std::to_string(from_.scale) +
                  " to " + std::to_string(to_.scale));
    const Box& box = internals(shape)->box();
    centre_ = 0.5 * (box.lo + box.hi);
    for (const Vec3& p : shape.sites().mesh().positions) radius_ = std::max(radius_, norm(p - centre_));
    find_rotation();
  }

  [[nodiscard]] Vec3 shift() const { return to_.map(centre_) - from_.map(centre_); }
  /// The largest speed of a point relative to the centre.
  [[nodiscard]] double turning_speed() const { return angle_ * radius_ * from_.scale; }

  [[nodiscard]] Transform at(double time) const {
    if (time == 0) return from_.transform();
    const double half = 0.5 * time * angle_;
    const Vec3 v = std::sin(half) * axis_;
    const Transform turn = Transform::quaternion({std::cos(half), v[0], v[1], v[2]});
    const Vec3 centre = from_.map(centre_);
    return Transform::translation(centre + time * shift()) * turn * Transform::translation(-centre) *
           from_.transform();
  }

 private:
  // The axis and the angle of R = to · from⁻¹. Half of R − Rᵀ is the axis times the sine, and the trace is 1
  // + 2 cosines; near 180°, the axis is the largest column of R + I.
  void find_rotation() {
    std::array<Vec3, 3> r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        r[i][j] = dot(to_.map.rows[i], from_.map.rows[j]) / (to_.scale * from_.scale);
    const Vec3 twice_sine{r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
    const double sine = 0.5 * norm(twice_sine), cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1);
    angle_ = std::atan2(sine, cosine);
    if (sine > 1e-8) {
      axis_ = normalized(twice_sine);
      return;
    }
    if (cosine > 0) {
      angle_ = 0;
      return;
    }
    for (std::size_t j = 0; j < 3; ++j) {
      Vec3 column{r[0][j], r[1][j], r[2][j]};
      column[j] += 1;
      if (norm(column) > norm(axis_)) axis_ = column;
    }
    axis_ = normalized(axis_);
  }

  Similarity from_, to_;
  Vec3 centre_{}, axis_{};
  double radius_ = 0, angle_ = 0;
};

}  // namespace

Transform Motion::at(double time, const Shape& shape) const {
  return DividedMotion(*this, shape).at(time);
}

TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2, const Motion& motion2,
                              double tolerance) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    throw Error("a tolerance of " + std::to_string(tolerance) + " is out of range; use more than 0");
  const std::array motions{DividedMotion(motion1, o1), DividedMotion(motion2, o2)};
  const double speed =
      norm(motions[1].shift() - motions[0].shift()) + motions[0].turning_speed() + motions[1].turning_speed();
  ProximityQuery query(o1, o2);
  TimeOfContact result{.time = 0};
  for (;;) {
    for (int body = 0; body < 2; ++body) query.set_pose(body, motions[body].at(result.time));
    result.separation = query.separation().value;
    result.contact = result.separation <= tolerance || (result.time == 0 && query.colliding().value);
    if (result.contact || result.time == 1) return result;
    // Half of the tolerance remains, far more than the distance is rounded by.
    const double step = (result.separation - 0.5 * tolerance) / speed;
    result.time = step < 1 - result.time ? result.time + step : 1;
  }
}

}  // namespace sdm
