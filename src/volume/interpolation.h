// Distances between the points of a grid.
#pragma once

#include <sdm/volume.h>

namespace sdm::volume {

/// Interpolates a field. The field must outlive it.
class Interpolation {
 public:
  /// Throws sdm::Error if the arrays of the field do not fit its grid.
  explicit Interpolation(const DistanceField& field);

  /// The point must be finite.
  [[nodiscard]] FieldSample operator()(const Vec3& p) const;

 private:
  const DistanceField& field_;
};

}  // namespace sdm::volume
