// The closest points and the collision of two convex solids.
#pragma once

#include <optional>

#include "bodies/convex/support_search.h"
#include "bodies/pairs/mesh_pair.h"

namespace sdm::convex {

/// Returns what pairs::find_closest() and pairs::colliding() find for two convex solids, to the bit, in less
/// time where it can be proven: the results are empty elsewhere, as where faces are parallel or the solids
/// nearly touch.
class ConvexPair {
 public:
  /// `scale`: of the pose.
  ConvexPair(const ConvexMesh& o1, const ConvexMesh& o2, const pairs::MeshPair& pair, double scale);

  /// As find_closest(), if its result is known. `hint` receives faces near the closest ones, unless the
  /// solids overlap. `simplex`: see search_by_supports().
  [[nodiscard]] std::optional<pairs::Separation> find_closest(double bound, Simplex& simplex,
                                                              pairs::FacePair& hint);
  /// Whether find_closest() found that the solids overlap: its result is then empty.
  [[nodiscard]] bool found_overlap() const { return found_overlap_; }
  /// Whether the solids have a point in common, if it is known.
  [[nodiscard]] std::optional<bool> colliding(Simplex& simplex);

 private:
  // Whether the balls about the centres overlap, beyond rounding errors.
  [[nodiscard]] bool centres_near() const;

  const ConvexMesh &o1_, &o2_;
  const pairs::MeshPair& pair_;
  double scale_, rounding_;
  bool found_overlap_ = false;
};

}  // namespace sdm::convex
