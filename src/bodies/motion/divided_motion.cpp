#include "bodies/motion/divided_motion.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bodies/shape/posed_body.h"
#include "geometry/vec.h"

namespace sdm::motion {

void check_tolerance(double tolerance) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    throw Error("a tolerance of " + std::to_string(tolerance) + " is out of range; use more than 0");
}

DividedMotion::DividedMotion(const Motion& motion, const Shape& shape)
    : DividedMotion(motion, internals(shape)->turning_box()) {}

DividedMotion::DividedMotion(const Motion& motion, const Box& box)
    : from_(mesh::Similarity::of(motion.from)) {
  const mesh::Similarity to = mesh::Similarity::of(motion.to);
  if (std::abs(to.scale - from_.scale) > 1e-5 * from_.scale)
    throw Error("the scale of a body changes during its motion from " + std::to_string(from_.scale) + " to " +
                std::to_string(to.scale));
  shape::check_posed(from_, box);
  shape::check_posed(to, box);
  middle_ = centre(box);
  start_ = from_.map(middle_);
  shift_ = to.map(middle_) - start_;
  find_rotation(to);
  find_rounding(0.5 * diagonal(box));
}

DividedMotion DividedMotion::of_part(const Transform& local, const Box& box) const {
  DividedMotion part = *this;
  part.from_ = mesh::Similarity::of(from_.transform() * local);
  shape::check_posed(part.from_, box);
  shape::check_posed(mesh::Similarity::of(at(1) * local), box);
  part.middle_ = centre(box);
  part.find_mesh_axis();
  part.find_rounding(0.5 * diagonal(box));
  return part;
}

// The axis and the angle of R = to · from⁻¹. Half of R − Rᵀ is the axis times the sine, and the trace is 1 +
// 2 cosines. The error of the axis is that of rounding divided by the sine: of no effect where the angle is
// small, but near 180° the axis is the largest column of R + I, which is twice its product with itself.
void DividedMotion::find_rotation(const mesh::Similarity& to) {
  std::array<Vec3, 3> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = dot(to.map.rows[i], from_.map.rows[j]) / (to.scale * from_.scale);
  const Vec3 twice_sine{r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
  const double sine = 0.5 * norm(twice_sine), cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1);
  if (sine == 0 && cosine > 0) return;
  angle_ = std::atan2(sine, cosine);
  axis_ = twice_sine;
  if (cosine < 0 && sine < 1e-8) {
    axis_ = {};
    for (std::size_t j = 0; j < 3; ++j) {
      Vec3 column{r[0][j], r[1][j], r[2][j]};
      column[j] += 1;
      if (norm(column) > norm(axis_)) axis_ = column;
    }
    if (dot(axis_, twice_sine) < 0) axis_ = -axis_;
  }
  axis_ = normalized(axis_);
  find_mesh_axis();
}

void DividedMotion::find_mesh_axis() {
  mesh_axis_ = {};
  if (!turns()) return;
  for (int k = 0; k < 3; ++k) mesh_axis_ += axis_[k] * from_.map.rows[k];
  mesh_axis_ = normalized(mesh_axis_);
}

// Translations: at most 16 roundings by half a unit, of poses, of the difference of two centres, of its
// motion, and of products with a direction. The points of a body: products with the matrix and a
// direction; if it turns, also sine, cosine, the matrix, its correction by set_pose, and speeds up to angle²
// times the radius.
void DividedMotion::find_rounding(double radius) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  const double size =
      from_.scale * (std::abs(middle_[0]) + std::abs(middle_[1]) + std::abs(middle_[2]) + radius);
  for (int k = 0; k < 3; ++k)
    rounding_[k] = kUnit * (8 * (std::abs(start_[k]) + std::abs(shift_[k])) + (turns() ? 64 : 16) * size);
}

std::array<Vec3, 3> DividedMotion::linear_at(double time) const {
  if (!turns() || time == 0) return from_.map.rows;
  const double half = 0.5 * time * angle_;
  const Vec3 v = std::sin(half) * axis_;
  const Transform turn = Transform::quaternion({std::cos(half), v[0], v[1], v[2]});
  std::array<Vec3, 3> rows{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rows[i] += turn.rows[i][j] * from_.map.rows[j];
  return rows;
}

Transform DividedMotion::at(double time) const {
  if (time == 0 || rests()) return from_.transform();
  mesh::Similarity pose{.map = {.rows = linear_at(time)}, .scale = from_.scale};
  pose.map.offset = start_ + time * shift_ - pose.map.linear(middle_);
  return pose.transform();
}

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
