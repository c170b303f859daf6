// Motions of O1 of which some freedoms are locked.
#pragma once

#include <sdm/align.h>

#include "geometry/affine.h"
#include "registration/eigen.h"

namespace sdm::registration {

/// The pose x ↦ about + exp(ω) (start(x) − about) + τ, of which the locked components of ω and τ are 0.
class LockedMotion {
 public:
  LockedMotion(const AlignFreedoms& freedoms, const Affine& start);

  /// An orthonormal basis of the small motions about the pivot that change the other components.
  [[nodiscard]] Motions allowed(const Pivot& pivot) const;
  /// Changes these components by a small motion in the span of allowed().
  void move(const Motion& motion, const Pivot& pivot);
  [[nodiscard]] Affine pose() const;

 private:
  [[nodiscard]] Motions tangents(const Pivot& pivot) const;

  AlignFreedoms freedoms_;
  Affine start_;
  Vec3 turn_{}, shift_{};  // ω and τ
};

}  // namespace sdm::registration
