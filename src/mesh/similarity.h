// The pose of a rigid body: a rotation, a uniform scale and a translation.
#pragma once

#include <sdm/mesh_edit.h>

#include "geometry/affine.h"

namespace sdm::mesh {

/// p ↦ scale · R p + offset.
struct Similarity {
  Affine map;  ///< with R corrected to a rotation, to rounding
  double scale = 1;

  /// Throws sdm::Error unless the linear part is a rotation times a positive factor, to 1e-5, and all entries
  /// are finite. Matrices in single precision are close enough. The identity stays exact.
  [[nodiscard]] static Similarity of(const Transform& pose);
  [[nodiscard]] Transform transform() const;
};

}  // namespace sdm::mesh
