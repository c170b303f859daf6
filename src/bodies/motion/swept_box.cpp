#include "bodies/motion/swept_box.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

namespace sdm::motion {

// A coordinate of a point is f(t) = start + t shift + R(t) q along an axis. With ρ the largest |q| and θ the
// angle, |f″| ≤ θ² ρ, so that f is within θ² ρ / 8 of the straight line from f(0) to f(1): the box around
// both ends, extended by that, contains the body. So does the box around the ball of radius ρ at both ends.
Box swept_box(const shape::Body& body, const DividedMotion& motion) {
  if (body.half_space()) return body.box();
  Vec3 half;  // of the box about the centre of the motion that contains all faces
  for (int k = 0; k < 3; ++k)
    half[k] = std::max(body.box().upper[k] - motion.middle()[k], motion.middle()[k] - body.box().lower[k]);
  const auto& [ball_centre, ball_radius] = body.ball();
  const double radius =
      motion.scale() * std::min(norm(half), norm(ball_centre - motion.middle()) + ball_radius);
  const double bend = motion.angle() * motion.angle() * radius / 8;
  const auto first = motion.linear_at(0), last = motion.linear_at(1);
  const auto extent = [&](const Vec3& row) {
    return std::min(std::abs(row[0]) * half[0] + std::abs(row[1]) * half[1] + std::abs(row[2]) * half[2],
                    radius);
  };
  Box box;
  for (int k = 0; k < 3; ++k) {
    const double from = motion.start()[k], to = from + motion.shift()[k];
    const double at_first = extent(first[k]), at_last = extent(last[k]);
    const double rounding = 2 * motion.rounding()[k];
    box.lower[k] = std::max(std::min(from - at_first, to - at_last) - bend, std::min(from, to) - radius);
    box.upper[k] = std::min(std::max(from + at_first, to + at_last) + bend, std::max(from, to) + radius);
    box.lower[k] -= rounding;
    box.upper[k] += rounding;
  }
  return box;
}

}  // namespace sdm::motion
