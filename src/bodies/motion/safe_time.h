// Until when parts of two moving bodies surely stay apart.
#pragma once

#include <array>

#include "bodies/motion/divided_motion.h"
#include "bodies/motion/parts.h"

namespace sdm::motion {

/// The motions of O1 and O2 from some time on.
class SafeTime {
 public:
  /// Bodies are safe while they are more than `reserve` apart, by more than rounding. The motions must
  /// outlive this object.
  SafeTime(const DividedMotion& motion1, const DividedMotion& motion2, double reserve);

  void set_now(double time);
  [[nodiscard]] double now() const { return now_; }

  /// A bound on the errors of points.
  [[nodiscard]] double rounding() const { return norm(rounding_); }

  /// A point of a body at this time, relative to the centre of O1. `p` as a Part has it.
  [[nodiscard]] Vec3 place(int body, const Vec3& p) const;
  /// A direction of the frame of a mesh in space; its length is scaled.
  [[nodiscard]] Vec3 turned(int body, const Vec3& direction) const;
  /// The velocity of point2, of O2, relative to point1, of O1; as place() returns them.
  [[nodiscard]] Vec3 velocity(const Vec3& point1, const Vec3& point2) const;

  /// A time until which the parts are safe: not before now, and infinite if they are safe for the rest of the
  /// motion. By their extents along `u`, a vector of length 1, or 0, which proves nothing. See
  /// docs/design/exact.md for the proof.
  [[nodiscard]] double until(const Part& part1, const Part& part2, const Vec3& u) const;

 private:
  std::array<const DividedMotion*, 2> motions_;
  double reserve_;
  Vec3 rounding_, closing_;  // of coordinates; the velocity of O1's centre relative to O2's
  double now_ = 0;
  std::array<std::array<Vec3, 3>, 2> linear_;
  Vec3 between_;  // from the centre of O1 to that of O2
};

}  // namespace sdm::motion
