// A motion of a body, divided into that of its centre and a rotation about it.
#pragma once

#include <sdm/proximity_query.h>

#include "bodies/shape/body.h"
#include "mesh/similarity.h"

namespace sdm::motion {

/// Throws sdm::Error unless it is finite and above 0.
void check_tolerance(double tolerance);

/// A motion: a point p of the mesh is, at the time t, at
///   start + t shift + R(t) q,   q = L (p − middle),
/// with L the linear part of the first pose and R(t) the rotation by t angle about the axis.
class DividedMotion {
 public:
  /// Throws sdm::Error as Motion::at does.
  DividedMotion(const Motion& motion, const Shape& shape);
  /// The motion of a mesh with this box.
  DividedMotion(const Motion& motion, const Box& box);
  /// The motion of a part of this body, whose pose in the frame of the body is `local`: it turns about the
  /// same axis by the same angle, which it would not do for sure if that were found again from its own poses.
  /// `box`: of the part, around the middle of the body. Throws sdm::Error as Motion::at does.
  [[nodiscard]] DividedMotion of_part(const Transform& local, const Box& box) const;

  [[nodiscard]] bool rests() const { return angle_ == 0 && shift_ == Vec3{}; }
  [[nodiscard]] bool turns() const { return angle_ > 0; }

  /// The middle of the mesh's box, in the frame of the mesh, and where it is at time 0.
  [[nodiscard]] const Vec3& middle() const { return middle_; }
  [[nodiscard]] const Vec3& start() const { return start_; }
  [[nodiscard]] const Vec3& shift() const { return shift_; }
  [[nodiscard]] double scale() const { return from_.scale; }

  /// The axis of rotation, of length 1, in space and in the frame of the mesh; 0 if the mesh does not turn.
  [[nodiscard]] const Vec3& axis() const { return axis_; }
  [[nodiscard]] const Vec3& mesh_axis() const { return mesh_axis_; }
  /// The angle of the whole rotation, in [0, π].
  [[nodiscard]] double angle() const { return angle_; }

  /// The rows of R(t) L.
  [[nodiscard]] std::array<Vec3, 3> linear_at(double time) const;
  [[nodiscard]] Transform at(double time) const;

  /// A bound on the errors, by rounding, of the coordinates of all points at all times: of those that at()
  /// gives, and of those that are computed relative to the centre of another body.
  [[nodiscard]] const Vec3& rounding() const { return rounding_; }

 private:
  void find_rotation(const mesh::Similarity& to);
  void find_mesh_axis();
  void find_rounding(double radius);

  mesh::Similarity from_;
  Vec3 middle_{}, start_{}, shift_{}, axis_{}, mesh_axis_{}, rounding_{};
  double angle_ = 0;
};

/// A box that contains the body at all times of the motion. Cost: constant.
[[nodiscard]] Box swept_box(const shape::Body& body, const DividedMotion& motion);

}  // namespace sdm::motion
