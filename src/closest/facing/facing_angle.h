// Which normals face the same way.
#pragma once

namespace sdm::facing {

/// Throws sdm::Error unless an angle in degrees is above 0 and at most 180.
void check_angle(double angle);

/// Normals within an angle; for 90° less than that.
class FacingAngle {
 public:
  /// `degrees` as of check_angle().
  explicit FacingAngle(double degrees);

  /// `cosine`: of two unit vectors.
  [[nodiscard]] bool allows(double cosine) const {
    return right_angle_ ? cosine > 0 : cosine >= least_cosine_;
  }

 private:
  bool right_angle_;
  double least_cosine_;
};

}  // namespace sdm::facing
