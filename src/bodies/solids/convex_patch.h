// The contacts of two convex bodies from a face, an edge or a vertex of each.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "bodies/shape/posed_body.h"
#include "bodies/solids/support_feature.h"

namespace sdm::solids {

/// The contact patch of two convex solids: the part that their supporting features have in common, seen along
/// the separating translation. There is a contact at each corner of this part: at a vertex of one feature
/// over the other one, and where two sides cross.
class ConvexPatch {
 public:
  /// The contacts of convex bodies that leave each other by the translation depth · normal of O1, or are
  /// −depth apart: point1 and point2 are on the surfaces and above each other, to rounding. Ids name the
  /// vertex or both edges. Sorted by depth, the deepest first, in the patch 0, none deeper than `depth`.
  /// Empty if nothing is as deep, to `tolerance`: these are then not the features that touch then. `size`: of
  /// both bodies. The span is valid until the next call.
  [[nodiscard]] std::span<const Contact> find(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                              const Vec3& normal, double depth, double size,
                                              double tolerance);

 private:
  void clip();
  void clip_by(const Vec2& a, const Vec2& b);
  void cross_segments();
  void add_contact(const Vec2& at);

  std::array<SupportFeature, 2> features_;
  std::vector<Vec2> corners_, clipped_;  // of the part in common, before and after a step
  Vec3 normal_{};
  double depth_ = 0;
  double near_ = 0;  // points of the plane that are no farther apart are one
  std::vector<Contact> contacts_;
};

}  // namespace sdm::solids
