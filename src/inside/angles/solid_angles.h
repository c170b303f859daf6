// Sums of the solid angles of many triangles, as accurately as needed: a tree code.
#pragma once

#include <sdm/types.h>

#include <cstdint>

#include "inside/angles/expansions.h"
#include "inside/angles/solid_angle.h"

namespace sdm::inside {

/// The sum of the solid angles of the faces of a tree. Distant subtrees are expanded about their centres,
/// eight at once, with a bound on the error of each (expansions.h).
class SolidAngles {
 public:
  /// `wide` is the tree of the faces, collapsed. Both must outlive this object and not change. Cost: linear.
  SolidAngles(const OrientedFaces& faces, const tree::WideTree& wide);

  /// The sum at a point q.
  struct Sum {
    SolidAngle angle;
    double safe_radius = 0;  ///< at points nearer to q than this, the sum is on the same side of the limit
  };
  /// The sum at q: refined, the largest errors first, until the error is well below its distance from
  /// `limit` or the error is at most `tolerance`, or until no expansion is left or the error is infinite: q
  /// is on a face.
  [[nodiscard]] Sum at(const Vec3& q, double limit, double tolerance) const;

  [[nodiscard]] bool empty() const { return expansions.nodes.empty(); }

  std::uint64_t number;  ///< unique, over all objects
  OrientedFaces faces;
  const tree::WideTree& wide;
  TreeExpansions expansions;
};

}  // namespace sdm::inside
